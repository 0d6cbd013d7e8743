//! Runs a WGSL program as an adapter may: in the arithmetic that WGSL permits at its worst ([`Arithmetic`]), and with sums and
//! products in any order ([`super::order`]).
//!
//! It runs the text that GPUs compile, so there is no second program to keep alike. Strictly it gives the bits of the CPU
//! rasterizer, which the tests ask.

use super::arithmetic::Arithmetic;
use super::builtin::{self, converted, of_integers};
use super::order;
use super::program::{Frame, Prepared, Program, STACK, literal_word, pointer, target};
use anyhow::{Result, bail, ensure};
use naga::{
    BinaryOperator, Block, Expression, Handle, RelationalFunction, ScalarKind, Statement, TypeInner, UnaryOperator,
};

/// Turns of loops in one call from outside, at most: a program of ours takes some thousand.
const TURNS: u32 = 1 << 20;

/// How a block ended.
#[derive(Clone, Copy, PartialEq)]
enum Flow {
    Next,
    Break,
    Continue,
    Return,
    Discard,
}

/// A program with its memory.
pub struct Machine<'p> {
    program: &'p Program<'p>,
    /// How it computes.
    pub arithmetic: Arithmetic,
    /// The stack, then global variables.
    memories: Vec<Vec<u32>>,
    /// What a function returns.
    returned: Vec<u32>,
    top: usize,
    turns: u32,
}

impl<'p> Machine<'p> {
    /// A machine whose bound variables hold what `bound` says of their group and binding.
    ///
    /// # Errors
    /// Where a private variable has no words.
    pub fn new(
        program: &'p Program<'p>,
        arithmetic: Arithmetic,
        bound: impl Fn(u32, u32) -> Option<Vec<u32>>,
    ) -> Result<Self> {
        let mut memories = vec![vec![]];
        for (variable, _) in program.globals() {
            memories.push(match &variable.binding {
                Some(at) => bound(at.group, at.binding).unwrap_or_default(),
                None => vec![0; program.private_words(variable)?],
            });
        }
        Ok(Self { program, arithmetic, memories, returned: vec![], top: 0, turns: 0 })
    }

    /// Calls a function with the words of its arguments; `None` where it discards.
    ///
    /// # Errors
    /// Where there is no such function, its arguments have other words, or its loops do not end.
    pub fn call(&mut self, name: &str, arguments: &[&[u32]]) -> Result<Option<Vec<u32>>> {
        let Some(index) = self.program.named(name) else { bail!("the program has no function `{name}`") };
        let callee = self.program.function(index);
        self.top = 0;
        self.turns = 0;
        self.enter(callee, 0);
        for (handle, expression) in callee.function.expressions.iter() {
            if let Expression::FunctionArgument(k) = expression {
                let (at, words) = callee.place(handle);
                let given = arguments.get(*k as usize).copied().unwrap_or_default();
                ensure!(given.len() == words, "argument {k} of `{name}` has {words} words, not {}", given.len());
                self.memories[STACK][at..at + words].copy_from_slice(given);
            }
        }
        let flow = self.block(callee, 0, &callee.function.body)?;
        Ok((flow != Flow::Discard).then(|| self.returned.clone()))
    }

    /// Makes room for a function's values from `base` on, and sets those that it has before its first statement.
    fn enter(&mut self, callee: &Prepared<'p>, base: usize) {
        self.top = base + callee.size;
        if self.memories[STACK].len() < self.top {
            self.memories[STACK].resize(self.top, 0);
        }
        for &handle in &callee.first {
            self.evaluate(callee, base, handle);
        }
        for (variable, local) in callee.function.local_variables.iter() {
            let at = base + callee.local(variable);
            match local.init {
                // Emitted before, as a constant.
                Some(init) => {
                    let (from, words) = callee.place(init);
                    self.evaluate(callee, base, init);
                    self.memories[STACK].copy_within(base + from..base + from + words, at);
                }
                None => {
                    let words = self.program.words(&self.program.module.types[local.ty].inner).expect("checked");
                    self.memories[STACK][at..at + words].fill(0);
                }
            }
        }
    }

    fn block(&mut self, f: &Prepared<'p>, base: usize, block: &Block) -> Result<Flow> {
        for statement in block.iter() {
            let flow = match statement {
                Statement::Emit(range) => {
                    for handle in range.clone() {
                        self.evaluate(f, base, handle);
                    }
                    Flow::Next
                }
                Statement::Block(block) => self.block(f, base, block)?,
                Statement::If { condition, accept, reject } => {
                    let chosen = if self.word(f, base, *condition, 0) != 0 { accept } else { reject };
                    self.block(f, base, chosen)?
                }
                Statement::Loop { body, continuing, break_if } => self.repeat(f, base, body, continuing, *break_if)?,
                Statement::Break => Flow::Break,
                Statement::Continue => Flow::Continue,
                Statement::Kill => Flow::Discard,
                Statement::Return { value } => {
                    self.returned.clear();
                    if let Some(value) = value {
                        let (at, words) = f.place(*value);
                        self.returned.extend_from_slice(&self.memories[STACK][base + at..base + at + words]);
                    }
                    Flow::Return
                }
                Statement::Store { pointer, value } => {
                    let (memory, to) = target(self.word(f, base, *pointer, 0));
                    let (at, words) = f.place(*value);
                    for k in 0..words {
                        let word = self.memories[STACK][base + at + k];
                        // Beyond a buffer's end nothing is written.
                        if let Some(place) = self.memories[memory].get_mut(to + k) {
                            *place = word;
                        }
                    }
                    Flow::Next
                }
                Statement::Call { function, arguments, result } => {
                    let callee = self.program.function(function.index());
                    let new = self.top;
                    self.enter(callee, new);
                    for (handle, expression) in callee.function.expressions.iter() {
                        if let Expression::FunctionArgument(k) = expression {
                            let (from, words) = f.place(arguments[*k as usize]);
                            let (to, _) = callee.place(handle);
                            self.memories[STACK].copy_within(base + from..base + from + words, new + to);
                        }
                    }
                    let flow = self.block(callee, new, &callee.function.body)?;
                    self.top = new;
                    if flow == Flow::Discard {
                        return Ok(flow);
                    }
                    if let Some(result) = result {
                        let (at, words) = f.place(*result);
                        self.memories[STACK][base + at..base + at + words].copy_from_slice(&self.returned[..words]);
                    }
                    Flow::Next
                }
                other => bail!("the statement {other:?} cannot be run"),
            };
            if flow != Flow::Next {
                return Ok(flow);
            }
        }
        Ok(Flow::Next)
    }

    fn repeat(
        &mut self,
        f: &Prepared<'p>,
        base: usize,
        body: &Block,
        continuing: &Block,
        break_if: Option<Handle<Expression>>,
    ) -> Result<Flow> {
        loop {
            self.turns += 1;
            ensure!(self.turns < TURNS, "a loop did not end in {TURNS} turns");
            match self.block(f, base, body)? {
                Flow::Break => return Ok(Flow::Next),
                Flow::Next | Flow::Continue => {}
                ended => return Ok(ended),
            }
            self.block(f, base, continuing)?;
            if break_if.is_some_and(|condition| self.word(f, base, condition, 0) != 0) {
                return Ok(Flow::Next);
            }
        }
    }

    /// The values of a function whose part of the stack begins at `base`, and what computes with them.
    fn split<'a>(&'a mut self, f: &'a Prepared<'p>, base: usize) -> (Frame<'a>, &'a mut Arithmetic) {
        (Frame { prepared: f, words: &self.memories[STACK][base..] }, &mut self.arithmetic)
    }

    fn word(&self, f: &Prepared<'p>, base: usize, handle: Handle<Expression>, lane: usize) -> u32 {
        Frame { prepared: f, words: &self.memories[STACK][base..] }.word(handle, lane)
    }

    /// Whether an expression is of floating-point numbers.
    fn is_real(&self, f: &Prepared<'p>, handle: Handle<Expression>) -> bool {
        f.kind(self.program.module, handle).scalar_kind() == Some(ScalarKind::Float)
    }

    /// Computes an expression.
    fn evaluate(&mut self, f: &Prepared<'p>, base: usize, handle: Handle<Expression>) {
        let (at, words) = f.place(handle);
        let to = base + at;
        match &f.function.expressions[handle] {
            Expression::Literal(literal) => {
                self.memories[STACK][to] = literal_word(*literal).expect("checked when prepared");
            }
            Expression::Constant(constant) => {
                self.memories[STACK][to..to + words].copy_from_slice(self.program.constant(*constant));
            }
            Expression::ZeroValue(_) => self.memories[STACK][to..to + words].fill(0),
            Expression::GlobalVariable(variable) => {
                self.memories[STACK][to] = pointer(self.program.memory(*variable), 0);
            }
            Expression::LocalVariable(variable) => {
                self.memories[STACK][to] = pointer(STACK, base + f.local(*variable));
            }
            Expression::Compose { components, .. } => {
                let mut to = to;
                for &component in components {
                    let (from, words) = f.place(component);
                    self.memories[STACK].copy_within(base + from..base + from + words, to);
                    to += words;
                }
            }
            Expression::Access { base: of, index } => {
                let index = self.word(f, base, *index, 0) as usize;
                self.access(f, base, *of, index, to);
            }
            Expression::AccessIndex { base: of, index } => self.access(f, base, *of, *index as usize, to),
            Expression::Splat { value, .. } => {
                let word = self.word(f, base, *value, 0);
                self.memories[STACK][to..to + words].fill(word);
            }
            Expression::Swizzle { vector, pattern, .. } => {
                for k in 0..words {
                    self.memories[STACK][to + k] = self.word(f, base, *vector, pattern[k] as usize);
                }
            }
            Expression::Load { pointer } => {
                let (memory, from) = target(self.word(f, base, *pointer, 0));
                for k in 0..words {
                    // Beyond a buffer's end, zero.
                    let word = self.memories[memory].get(from + k).copied().unwrap_or(0);
                    self.memories[STACK][to + k] = word;
                }
            }
            Expression::Select { condition, accept, reject } => {
                for k in 0..words {
                    let chosen = if self.word(f, base, *condition, k) != 0 { *accept } else { *reject };
                    self.memories[STACK][to + k] = self.word(f, base, chosen, k);
                }
            }
            Expression::Relational { fun, argument } => {
                let (from, count) = f.place(*argument);
                let lanes = &self.memories[STACK][base + from..base + from + count];
                let found = match fun {
                    RelationalFunction::Any => lanes.iter().any(|&x| x != 0),
                    _ => lanes.iter().all(|&x| x != 0),
                };
                self.memories[STACK][to] = u32::from(found);
            }
            Expression::As { expr, kind, convert } => {
                let from = f.kind(self.program.module, *expr).scalar_kind();
                for k in 0..words {
                    let word = self.word(f, base, *expr, k);
                    self.memories[STACK][to + k] = if convert.is_some() { converted(word, from, *kind) } else { word };
                }
            }
            &Expression::Unary { op, expr } => {
                let is_real = self.is_real(f, expr);
                for k in 0..words {
                    let word = self.word(f, base, expr, k);
                    self.memories[STACK][to + k] = match op {
                        UnaryOperator::Negate if is_real => word ^ 0x8000_0000,
                        UnaryOperator::Negate => word.wrapping_neg(),
                        UnaryOperator::LogicalNot => u32::from(word == 0),
                        UnaryOperator::BitwiseNot => !word,
                    };
                }
            }
            &Expression::Binary { op, left, right } => {
                let is_real = self.is_real(f, left);
                for k in 0..words {
                    self.memories[STACK][to + k] = if is_real {
                        self.of_reals(f, base, handle, (op, left, right), k)
                    } else {
                        let [a, b] = [left, right].map(|x| self.word(f, base, x, k));
                        of_integers(op, a, b)
                    };
                }
            }
            &Expression::Math { fun, arg, arg1, arg2, .. } => {
                let more = [arg1.unwrap_or(arg), arg2.unwrap_or(arg)];
                let is_real = self.is_real(f, arg);
                let (frame, arithmetic) = self.split(f, base);
                let found = builtin::math(arithmetic, &frame, fun, [arg, more[0], more[1]], is_real, words);
                self.memories[STACK][to..to + words].copy_from_slice(&found[..words]);
            }
            // Set where the function is called.
            Expression::FunctionArgument(_) | Expression::CallResult(_) => {}
            other => unreachable!("{other:?} was refused when the program was prepared"),
        }
    }

    /// A part of a value, or a pointer to it.
    fn access(&mut self, f: &Prepared<'p>, base: usize, of: Handle<Expression>, index: usize, to: usize) {
        let kind = f.kind(self.program.module, of);
        let (words, part) = self.program.part(kind, index);
        let (from, count) = f.place(of);
        if matches!(kind, TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. }) {
            let (memory, at) = target(self.memories[STACK][base + from]);
            self.memories[STACK][to] = pointer(memory, at + part);
        } else {
            // Beyond its end, the last part.
            let part = part.min(count - words);
            self.memories[STACK].copy_within(base + from + part..base + from + part + words, to);
        }
    }

    fn of_reals(
        &mut self,
        f: &Prepared<'p>,
        base: usize,
        handle: Handle<Expression>,
        (op, left, right): (BinaryOperator, Handle<Expression>, Handle<Expression>),
        lane: usize,
    ) -> u32 {
        use BinaryOperator::*;
        let (frame, arithmetic) = self.split(f, base);
        let [a, b] = [left, right].map(|x| frame.number(x, lane));
        match op {
            Add | Subtract => order::sum(arithmetic, &frame, handle, lane).to_bits(),
            Multiply => order::product(arithmetic, &frame, handle, lane).to_bits(),
            Divide => arithmetic.divide(a, b).to_bits(),
            _ => {
                let [a, b] = [a, b].map(|x| arithmetic.flushed(x));
                u32::from(match op {
                    Equal => a == b,
                    NotEqual => a != b,
                    Less => a < b,
                    LessEqual => a <= b,
                    Greater => a > b,
                    _ => a >= b,
                })
            }
        }
    }
}
