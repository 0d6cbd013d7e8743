//! One function, rewritten: each operator on floats becomes calls, a component at a time.

use super::calls::Calls;
use naga::proc::Emitter;
use naga::valid::FunctionInfo;
use naga::{
    AtomicFunction, BinaryOperator, Block, Expression, Function, Handle, MathFunction, Module, Scalar, ScalarKind,
    Span, Statement, SwitchCase, Type, TypeInner, UnaryOperator, VectorSize,
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

    // Statements

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

    // Values

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

    fn binary(
        &mut self,
        op: BinaryOperator,
        a: (Value, Shape),
        b: (Value, Shape),
        block: &mut Block,
    ) -> Result<Value, String> {
        use BinaryOperator::{
            Add, Divide, Equal, Greater, GreaterEqual, Less, LessEqual, Multiply, NotEqual, Subtract,
        };
        let (operation, operands, kind) = match op {
            Add => ("ieee_sum", [a, b], ScalarKind::Float),
            Subtract => ("ieee_difference", [a, b], ScalarKind::Float),
            Multiply => ("ieee_product", [a, b], ScalarKind::Float),
            Divide => ("ieee_quotient", [a, b], ScalarKind::Float),
            Less => ("ieee_less", [a, b], ScalarKind::Bool),
            Greater => ("ieee_less", [b, a], ScalarKind::Bool),
            LessEqual => ("ieee_at_most", [a, b], ScalarKind::Bool),
            GreaterEqual => ("ieee_at_most", [b, a], ScalarKind::Bool),
            Equal => ("ieee_equal", [a, b], ScalarKind::Bool),
            NotEqual => ("ieee_unequal", [a, b], ScalarKind::Bool),
            other => return Err(format!("no strict form of {other:?} on floats")),
        };
        self.each(operation, &operands, kind, block)
    }

    /// A function of floats; `None` where it has none, or is exact on every adapter.
    fn math(
        &mut self,
        fun: MathFunction,
        operands: &[(Value, Shape)],
        block: &mut Block,
    ) -> Result<Option<Value>, String> {
        use MathFunction::{Abs, Ceil, Clamp, Cross, Dot, Floor, Max, Min, Mix, Round, Sqrt, Transpose};
        if operands.is_empty() {
            return Ok(None);
        }
        let operation = match fun {
            Abs => "ieee_magnitude",
            Min => "ieee_least",
            Max => "ieee_greatest",
            Clamp => "ieee_clamped",
            Sqrt => "ieee_root",
            Floor | Ceil | Round | Transpose => return Ok(None),
            Dot => return self.dot(operands[0], operands[1].0, block).map(Some),
            Cross => return self.cross(operands[0].0, operands[1].0, block).map(Some),
            Mix => {
                // x + (y − x) z, as the twin has it.
                let [x, y, z] = [operands[0], operands[1], operands[2]];
                let way = self.each("ieee_difference", &[y, x], ScalarKind::Float, block)?;
                let part = self.each("ieee_product", &[(way, x.1), z], ScalarKind::Float, block)?;
                return self.each("ieee_sum", &[x, (part, x.1)], ScalarKind::Float, block).map(Some);
            }
            other => return Err(format!("no strict form of {other:?}")),
        };
        self.each(operation, operands, ScalarKind::Float, block).map(Some)
    }

    /// The scalar product, summed from the first component on.
    fn dot(&mut self, (a, shape): (Value, Shape), b: Value, block: &mut Block) -> Result<Value, String> {
        let mut sum = None;
        for i in 0..lanes(shape) {
            let (x, y) = (self.component(a, shape, i, block), self.component(b, shape, i, block));
            let product = self.call("ieee_product", vec![x, y], block)?;
            sum = Some(match sum {
                Some(sum) => self.call("ieee_sum", vec![sum, product], block)?,
                None => product,
            });
        }
        Ok(sum.expect("a vector has components"))
    }

    fn cross(&mut self, a: Value, b: Value, block: &mut Block) -> Result<Value, String> {
        let shape = Shape::Several(VectorSize::Tri);
        let mut components = vec![];
        for (i, j) in [(1, 2), (2, 0), (0, 1)] {
            let mut product = |i: u32, j: u32| {
                let (x, y) = (self.component(a, shape, i, block), self.component(b, shape, j, block));
                self.call("ieee_product", vec![x, y], block)
            };
            let (first, second) = (product(i, j)?, product(j, i)?);
            components.push(self.call("ieee_difference", vec![first, second], block)?);
        }
        Ok(self.vector(VectorSize::Tri, ScalarKind::Float, components, block))
    }

    /// An operation on each component; a number beside a vector goes with all of its components.
    fn each(
        &mut self,
        name: &'static str,
        operands: &[(Value, Shape)],
        kind: ScalarKind,
        block: &mut Block,
    ) -> Result<Value, String> {
        let shape = operands.iter().map(|(_, shape)| *shape).find(|shape| *shape != Shape::One).unwrap_or(Shape::One);
        let mut made = vec![];
        for i in 0..lanes(shape) {
            let arguments = operands.iter().map(|&(value, shape)| self.component(value, shape, i, block)).collect();
            made.push(self.call(name, arguments, block)?);
        }
        Ok(match shape {
            Shape::One => made[0],
            Shape::Several(size) => self.vector(size, kind, made, block),
        })
    }

    fn component(&mut self, value: Value, shape: Shape, index: u32, block: &mut Block) -> Value {
        if shape == Shape::One {
            return value;
        }
        match &self.new.expressions[value] {
            Expression::Splat { value, .. } => *value,
            Expression::Compose { components, .. } if components.len() == lanes(shape) as usize => {
                components[index as usize]
            }
            _ => self.append(Expression::AccessIndex { base: value, index }, block),
        }
    }

    fn vector(&mut self, size: VectorSize, kind: ScalarKind, components: Vec<Value>, block: &mut Block) -> Value {
        let scalar = if kind == ScalarKind::Bool { Scalar::BOOL } else { Scalar::F32 };
        let inner = TypeInner::Vector { size, scalar };
        let ty = self.module.types.insert(Type { name: None, inner }, Span::UNDEFINED);
        self.append(Expression::Compose { ty, components }, block)
    }

    fn call(&mut self, name: &'static str, arguments: Vec<Value>, block: &mut Block) -> Result<Value, String> {
        let function = self.calls.get(name)?;
        self.end_emitting(block);
        let result = self.new.expressions.append(Expression::CallResult(function), Span::UNDEFINED);
        block.push(Statement::Call { function, arguments, result: Some(result) }, Span::UNDEFINED);
        self.emitter.start(&self.new.expressions);
        Ok(result)
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

fn lanes(shape: Shape) -> u32 {
    match shape {
        Shape::One => 1,
        Shape::Several(size) => size as u32,
    }
}
