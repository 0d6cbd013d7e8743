//! Operators on floats, written as calls: a component at a time.

use super::{Shape, Value, Writer};
use naga::{
    BinaryOperator, Block, Expression, MathFunction, Scalar, ScalarKind, Span, Statement, Type, TypeInner, VectorSize,
};

impl Writer<'_> {
    pub(super) fn binary(
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
    pub(super) fn math(
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
    pub(super) fn each(
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
}

fn lanes(shape: Shape) -> u32 {
    match shape {
        Shape::One => 1,
        Shape::Several(size) => size as u32,
    }
}
