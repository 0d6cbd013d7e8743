//! One function, rewritten: its statements and values, of which operators on floats become calls.

mod operators;

use super::calls::Calls;
use naga::proc::Emitter;
use naga::valid::FunctionInfo;
use naga::{
    AtomicFunction, Block, Expression, Function, Handle, Module, Scalar, ScalarKind, Span, Statement, SwitchCase,
    TypeInner, UnaryOperator, VectorSize,
};

type Value = Handle<Expression>;

/// The function with calls of functions in the place of its operators on floats.
///
/// # Errors
/// Where it holds one that has no strict form.
pub fn strict(old: &Function, info: &FunctionInfo, module: &mut Module, calls: &Calls) -> Result<Function, String> {
    let new = Function {
        name: old.name.clone(),
        arguments: old.arguments.clone(),
        result: old.result.clone(),
        local_variables: old.local_variables.clone(),
        ..Function::default()
    };
    let values = vec![None; old.expressions.len()];
    let mut writer = Writer { old, info, module, calls, new, values, emitter: Emitter::default() };
    for (variable, local) in old.local_variables.iter() {
        let init = local.init.map(|init| writer.value(init)).transpose()?;
        writer.new.local_variables[variable].init = init;
    }
    writer.new.body = writer.block(&old.body)?;
    for (value, name) in &old.named_expressions {
        if let Some(value) = writer.values[value.index()] {
            writer.new.named_expressions.insert(value, name.clone());
        }
    }
    Ok(writer.new)
}

struct Writer<'f> {
    old: &'f Function,
    info: &'f FunctionInfo,
    module: &'f mut Module,
    calls: &'f Calls,
    new: Function,
    /// What stands in the place of each of the old function's values.
    values: Vec<Option<Value>>,
    emitter: Emitter,
}

/// An operand or a result: one number or the numbers of a vector.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shape {
    One,
    Several(VectorSize),
}

impl Writer<'_> {
    fn kind(&self, value: Value) -> &TypeInner {
        self.info[value].ty.inner_with(&self.module.types)
    }

    /// Of floats, how many they are; `None` of anything else.
    fn floats(&self, value: Value) -> Option<Shape> {
        match *self.kind(value) {
            TypeInner::Scalar(Scalar { kind: ScalarKind::Float, .. }) => Some(Shape::One),
            TypeInner::Vector { size, scalar: Scalar { kind: ScalarKind::Float, .. } } => Some(Shape::Several(size)),
            _ => None,
        }
    }

    fn is_matrix(&self, value: Value) -> bool {
        matches!(self.kind(value), TypeInner::Matrix { .. })
    }

    fn block(&mut self, old: &Block) -> Result<Block, String> {
        let mut new = Block::new();
        for (statement, &span) in old.span_iter() {
            self.statement(statement, span, &mut new)?;
        }
        Ok(new)
    }

    fn statement(&mut self, statement: &Statement, span: Span, block: &mut Block) -> Result<(), String> {
        let rewritten = match statement {
            Statement::Emit(range) => {
                self.emitter.start(&self.new.expressions);
                for value in range.clone() {
                    let rewritten = self.emitted(value, block)?;
                    self.values[value.index()] = Some(rewritten);
                }
                self.end_emitting(block);
                return Ok(());
            }
            Statement::Block(inner) => Statement::Block(self.block(inner)?),
            Statement::If { condition, accept, reject } => Statement::If {
                condition: self.value(*condition)?,
                accept: self.block(accept)?,
                reject: self.block(reject)?,
            },
            Statement::Switch { selector, cases } => {
                let selector = self.value(*selector)?;
                let mut rewritten = vec![];
                for case in cases {
                    rewritten.push(SwitchCase { body: self.block(&case.body)?, ..case.clone() });
                }
                Statement::Switch { selector, cases: rewritten }
            }
            Statement::Loop { body, continuing, break_if } => {
                let (body, continuing) = (self.block(body)?, self.block(continuing)?);
                Statement::Loop { body, continuing, break_if: self.maybe(*break_if)? }
            }
            Statement::Return { value } => Statement::Return { value: self.maybe(*value)? },
            Statement::Store { pointer, value } => {
                Statement::Store { pointer: self.value(*pointer)?, value: self.value(*value)? }
            }
            Statement::ImageStore { image, coordinate, array_index, value } => Statement::ImageStore {
                image: self.value(*image)?,
                coordinate: self.value(*coordinate)?,
                array_index: self.maybe(*array_index)?,
                value: self.value(*value)?,
            },
            Statement::Atomic { pointer, fun, value, result } => Statement::Atomic {
                pointer: self.value(*pointer)?,
                fun: match *fun {
                    AtomicFunction::Exchange { compare } => AtomicFunction::Exchange { compare: self.maybe(compare)? },
                    fun => fun,
                },
                value: self.value(*value)?,
                result: result.map(|result| self.result(result)),
            },
            Statement::Call { function, arguments, result } => {
                let arguments = arguments.iter().map(|argument| self.value(*argument)).collect::<Result<_, _>>()?;
                Statement::Call { function: *function, arguments, result: result.map(|result| self.result(result)) }
            }
            Statement::Break | Statement::Continue | Statement::Kill | Statement::ControlBarrier(_) => {
                statement.clone()
            }
            other => return Err(format!("no strict form of {other:?}")),
        };
        block.push(rewritten, span);
        Ok(())
    }

    /// What a statement makes: it has its value without being emitted.
    fn result(&mut self, value: Value) -> Value {
        let made = self.new.expressions.append(self.old.expressions[value].clone(), Span::UNDEFINED);
        self.values[value.index()] = Some(made);
        made
    }

    fn maybe(&mut self, value: Option<Value>) -> Result<Option<Value>, String> {
        value.map(|value| self.value(value)).transpose()
    }

    /// What stands in the place of a value; a constant that no statement emits is copied when it is first asked for.
    fn value(&mut self, value: Value) -> Result<Value, String> {
        if let Some(known) = self.values[value.index()] {
            return Ok(known);
        }
        let copied = self.copied(value)?;
        let made = self.new.expressions.append(copied, Span::UNDEFINED);
        self.values[value.index()] = Some(made);
        Ok(made)
    }

    /// Adds an expression to those that are being emitted. What is never emitted interrupts them.
    fn append(&mut self, expression: Expression, block: &mut Block) -> Value {
        if !expression.needs_pre_emit() {
            return self.new.expressions.append(expression, Span::UNDEFINED);
        }
        self.end_emitting(block);
        let value = self.new.expressions.append(expression, Span::UNDEFINED);
        self.emitter.start(&self.new.expressions);
        value
    }

    fn end_emitting(&mut self, block: &mut Block) {
        block.extend(self.emitter.finish(&self.new.expressions));
    }

    /// The value of an emitted expression.
    fn emitted(&mut self, value: Value, block: &mut Block) -> Result<Value, String> {
        // Operands that nothing emits come first, lest they interrupt what follows.
        self.end_emitting(block);
        let copied = self.copied(value)?;
        self.emitter.start(&self.new.expressions);
        let old = &self.old.expressions[value];
        match (old, &copied) {
            (Expression::Unary { op: UnaryOperator::Negate, expr: of }, Expression::Unary { expr, .. }) => {
                if let Some(shape) = self.floats(*of) {
                    return self.each("ieee_negative", &[(*expr, shape)], ScalarKind::Float, block);
                }
            }
            (Expression::Binary { left, right, .. }, &Expression::Binary { op, left: a, right: b }) => {
                if self.is_matrix(*left) || self.is_matrix(*right) {
                    return Err(format!("no strict form of {op:?} on a matrix"));
                }
                if let (Some(of_a), Some(of_b)) = (self.floats(*left), self.floats(*right)) {
                    return self.binary(op, (a, of_a), (b, of_b), block);
                }
            }
            (
                Expression::Math { arg, arg1: of_1, arg2: of_2, .. },
                &Expression::Math { fun, arg: a, arg1, arg2, .. },
            ) => {
                // A number may stand beside vectors.
                let shape = |of: Option<Value>| of.and_then(|of| self.floats(of));
                let operands = [(Some(a), shape(Some(*arg))), (arg1, shape(*of_1)), (arg2, shape(*of_2))];
                let operands: Vec<_> = operands.into_iter().filter_map(|(value, shape)| value.zip(shape)).collect();
                return match self.math(fun, &operands, block)? {
                    Some(made) => Ok(made),
                    None => Ok(self.append(copied, block)),
                };
            }
            _ => {}
        }
        Ok(self.append(copied, block))
    }

    /// An expression with the new function's operands.
    fn copied(&mut self, value: Value) -> Result<Expression, String> {
        Ok(match &self.old.expressions[value] {
            same @ (Expression::Literal(_)
            | Expression::Constant(_)
            | Expression::Override(_)
            | Expression::ZeroValue(_)
            | Expression::FunctionArgument(_)
            | Expression::GlobalVariable(_)
            | Expression::LocalVariable(_)) => same.clone(),
            Expression::Compose { ty, components } => {
                let components = components.iter().map(|c| self.value(*c)).collect::<Result<_, _>>()?;
                Expression::Compose { ty: *ty, components }
            }
            Expression::Access { base, index } => {
                Expression::Access { base: self.value(*base)?, index: self.value(*index)? }
            }
            Expression::AccessIndex { base, index } => {
                Expression::AccessIndex { base: self.value(*base)?, index: *index }
            }
            Expression::Splat { size, value } => Expression::Splat { size: *size, value: self.value(*value)? },
            Expression::Swizzle { size, vector, pattern } => {
                Expression::Swizzle { size: *size, vector: self.value(*vector)?, pattern: *pattern }
            }
            Expression::Load { pointer } => Expression::Load { pointer: self.value(*pointer)? },
            Expression::ImageLoad { image, coordinate, array_index, sample, level } => Expression::ImageLoad {
                image: self.value(*image)?,
                coordinate: self.value(*coordinate)?,
                array_index: self.maybe(*array_index)?,
                sample: self.maybe(*sample)?,
                level: self.maybe(*level)?,
            },
            Expression::Unary { op, expr } => Expression::Unary { op: *op, expr: self.value(*expr)? },
            Expression::Binary { op, left, right } => {
                Expression::Binary { op: *op, left: self.value(*left)?, right: self.value(*right)? }
            }
            Expression::Select { condition, accept, reject } => Expression::Select {
                condition: self.value(*condition)?,
                accept: self.value(*accept)?,
                reject: self.value(*reject)?,
            },
            Expression::Relational { fun, argument } => {
                Expression::Relational { fun: *fun, argument: self.value(*argument)? }
            }
            Expression::Math { fun, arg, arg1, arg2, arg3 } => Expression::Math {
                fun: *fun,
                arg: self.value(*arg)?,
                arg1: self.maybe(*arg1)?,
                arg2: self.maybe(*arg2)?,
                arg3: self.maybe(*arg3)?,
            },
            Expression::ArrayLength(of) => Expression::ArrayLength(self.value(*of)?),
            Expression::As { expr, kind, convert } => {
                Expression::As { expr: self.value(*expr)?, kind: *kind, convert: *convert }
            }
            other => return Err(format!("no strict form of {other:?}")),
        })
    }
}
