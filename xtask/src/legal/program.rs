//! A WGSL program, ready to be run a statement at a time: naga's tree of it, and where each value of a function stands.
//!
//! A value is a row of words of 32 bits: scalars, and vectors, matrices, arrays and structures as the words of their parts one
//! after the other, without padding. A pointer is one word, see [`pointer()`].

use anyhow::{Context, Result, bail, ensure};
use naga::valid::{Capabilities, FunctionInfo, ModuleInfo, ValidationFlags, Validator};
use naga::{
    AddressSpace, ArraySize, BinaryOperator, Block, Expression, Function, GlobalVariable, Handle, Literal,
    MathFunction, Module, Statement, Type, TypeInner,
};
use std::collections::HashMap;

/// Bits of a pointer that say where in its memory it points.
const OFFSET_BITS: u32 = 27;

/// The memory of functions' values; global variables have those from 1 on.
pub const STACK: usize = 0;

/// A pointer to a word of a memory.
pub fn pointer(memory: usize, at: usize) -> u32 {
    ((memory as u32) << OFFSET_BITS) | at as u32
}

/// The memory of a pointer, and the word.
pub fn target(pointer: u32) -> (usize, usize) {
    ((pointer >> OFFSET_BITS) as usize, (pointer & ((1 << OFFSET_BITS) - 1)) as usize)
}

/// A function: where its values stand in its part of the stack.
pub struct Prepared<'m> {
    /// As naga reads it.
    pub function: &'m Function,
    info: &'m FunctionInfo,
    /// Where each expression stands, and how many words it has.
    places: Vec<(usize, usize)>,
    /// Where each variable stands.
    locals: Vec<usize>,
    /// How many words it takes.
    pub size: usize,
    /// Expressions that have their value before the first statement.
    pub first: Vec<Handle<Expression>>,
}

impl Prepared<'_> {
    /// Where an expression stands, and how many words it has.
    pub fn place(&self, expression: Handle<Expression>) -> (usize, usize) {
        self.places[expression.index()]
    }

    /// Where a variable stands.
    pub fn local(&self, variable: Handle<naga::LocalVariable>) -> usize {
        self.locals[variable.index()]
    }

    /// The type of an expression.
    pub fn kind<'p>(&'p self, module: &'p Module, expression: Handle<Expression>) -> &'p TypeInner {
        self.info[expression].ty.inner_with(&module.types)
    }

    /// Whether it is computed once and used more than once, or has a name: then it has one value, which no reordering opens up.
    pub fn is_kept(&self, expression: Handle<Expression>) -> bool {
        self.function.named_expressions.contains_key(&expression) || self.info[expression].ref_count > 1
    }
}

/// The values of a function that runs.
pub struct Frame<'a> {
    /// The function.
    pub prepared: &'a Prepared<'a>,
    /// Its part of the stack, and what is behind it.
    pub words: &'a [u32],
}

impl Frame<'_> {
    /// A word of an expression's value; of a scalar beside a vector, the scalar.
    pub fn word(&self, handle: Handle<Expression>, lane: usize) -> u32 {
        let (at, words) = self.prepared.place(handle);
        self.words[at + if words == 1 { 0 } else { lane }]
    }

    /// The same as a number.
    pub fn number(&self, handle: Handle<Expression>, lane: usize) -> f32 {
        f32::from_bits(self.word(handle, lane))
    }
}

/// A program's text, read and checked.
pub struct Source {
    module: Module,
    info: ModuleInfo,
}

impl Source {
    /// Reads WGSL.
    ///
    /// # Errors
    /// Where naga refuses it.
    pub fn new(wgsl: &str) -> Result<Self> {
        let module = naga::front::wgsl::parse_str(wgsl).map_err(|error| anyhow::anyhow!(error.emit_to_string(wgsl)))?;
        let info = Validator::new(ValidationFlags::all(), Capabilities::all())
            .validate(&module)
            .map_err(|error| anyhow::anyhow!(error.emit_to_string(wgsl)))?;
        Ok(Self { module, info })
    }
}

/// A program, of which some functions can be called.
pub struct Program<'m> {
    /// As naga reads it.
    pub module: &'m Module,
    /// Functions by their handles' numbers; after them, entry points in their order. `None` where no called one reaches it.
    functions: Vec<Option<Prepared<'m>>>,
    by_name: HashMap<&'m str, usize>,
    /// Words of each constant.
    constants: Vec<Vec<u32>>,
}

impl<'m> Program<'m> {
    /// Prepares functions and entry points of these names, and all that they call.
    ///
    /// # Errors
    /// Where there is none of a name, or something in one of them cannot be run.
    pub fn new(source: &'m Source, names: &[&str]) -> Result<Self> {
        let Source { module, info } = source;
        let count = module.functions.len();
        let mut program = Self { module, functions: vec![], by_name: HashMap::new(), constants: vec![] };
        program.functions.resize_with(count + module.entry_points.len(), || None);
        for (_, constant) in module.constants.iter() {
            let mut words = vec![];
            program.constant_words(constant.init, &mut words)?;
            program.constants.push(words);
        }
        let mut wanted = vec![];
        for (handle, function) in module.functions.iter() {
            program.by_name.extend(function.name.as_deref().map(|name| (name, handle.index())));
        }
        for (i, entry) in module.entry_points.iter().enumerate() {
            program.by_name.insert(&entry.name, count + i);
        }
        for name in names {
            wanted.push(*program.by_name.get(name).with_context(|| format!("the program has no function `{name}`"))?);
        }
        while let Some(index) = wanted.pop() {
            if program.functions[index].is_some() {
                continue;
            }
            let (function, facts) = match index.checked_sub(count) {
                Some(entry) => (&module.entry_points[entry].function, info.get_entry_point(entry)),
                None => {
                    let (handle, function) = module.functions.iter().nth(index).expect("an index of a function");
                    (function, &info[handle])
                }
            };
            let prepared = program.prepared(function, facts)?;
            calls(&function.body, &mut wanted);
            program.functions[index] = Some(prepared);
        }
        Ok(program)
    }

    fn prepared(&self, function: &'m Function, info: &'m FunctionInfo) -> Result<Prepared<'m>> {
        let mut size = 0;
        let mut take = |words: usize| {
            size += words;
            size - words
        };
        let mut places = vec![];
        let mut first = vec![];
        for (handle, expression) in function.expressions.iter() {
            ensure_can_be_run(expression)?;
            let words = self.words(info[handle].ty.inner_with(&self.module.types))?;
            if let Expression::Binary { left, right, .. } = expression {
                let is_matrix = |x: &Handle<Expression>| {
                    matches!(info[*x].ty.inner_with(&self.module.types), TypeInner::Matrix { .. })
                };
                ensure!(!is_matrix(left) && !is_matrix(right), "an operation on a matrix cannot be run");
            }
            places.push((take(words), words));
            if matches!(
                expression,
                Expression::Literal(_)
                    | Expression::Constant(_)
                    | Expression::ZeroValue(_)
                    | Expression::GlobalVariable(_)
                    | Expression::LocalVariable(_)
            ) {
                first.push(handle);
            }
        }
        let words = |variable: &naga::LocalVariable| self.words(&self.module.types[variable.ty].inner);
        let locals = function.local_variables.iter().map(|(_, variable)| Ok(take(words(variable)?)));
        let locals = locals.collect::<Result<Vec<_>>>()?;
        Ok(Prepared { function, info, places, locals, size, first })
    }

    /// A function that was asked for, or that one of them calls.
    pub fn function(&self, index: usize) -> &Prepared<'m> {
        self.functions[index].as_ref().expect("prepared with those that call it")
    }

    /// The number of a function by its name.
    pub fn named(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied().filter(|&index| self.functions[index].is_some())
    }

    /// Words of a constant.
    pub fn constant(&self, handle: Handle<naga::Constant>) -> &[u32] {
        &self.constants[handle.index()]
    }

    /// The memory that a global variable is, and the buffer it is bound to, if any.
    pub fn memory(&self, variable: Handle<GlobalVariable>) -> usize {
        variable.index() + 1
    }

    /// How many words a type has; a runtime-sized array or a texture has none.
    ///
    /// # Errors
    /// Where numbers are not of 32 bits.
    pub fn words(&self, inner: &TypeInner) -> Result<usize> {
        let of = |handle: Handle<Type>| self.words(&self.module.types[handle].inner);
        Ok(match inner {
            TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => {
                ensure!(
                    scalar.width == 4 || scalar.kind == naga::ScalarKind::Bool,
                    "a scalar of {} bytes",
                    scalar.width
                );
                1
            }
            TypeInner::Vector { size, .. } => *size as usize,
            TypeInner::Matrix { columns, rows, .. } => *columns as usize * *rows as usize,
            TypeInner::Array { base, size: ArraySize::Constant(count), .. } => of(*base)? * count.get() as usize,
            TypeInner::Struct { members, .. } => {
                let mut words = 0;
                for member in members {
                    words += of(member.ty)?;
                }
                words
            }
            TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. } => 1,
            TypeInner::Array { .. } | TypeInner::Image { .. } => 0,
            other => bail!("no words for {other:?}"),
        })
    }

    /// How many words a part of a composite has, and where it begins.
    pub fn part(&self, inner: &TypeInner, index: usize) -> (usize, usize) {
        let words = |handle: Handle<Type>| self.words(&self.module.types[handle].inner).expect("checked when prepared");
        match inner {
            TypeInner::Vector { .. } | TypeInner::ValuePointer { .. } => (1, index),
            TypeInner::Matrix { rows, .. } => (*rows as usize, *rows as usize * index),
            TypeInner::Array { base, .. } => (words(*base), words(*base) * index),
            TypeInner::Struct { members, .. } => {
                let before: usize = members[..index].iter().map(|member| words(member.ty)).sum();
                (words(members[index].ty), before)
            }
            TypeInner::Pointer { base, .. } => self.part(&self.module.types[*base].inner, index),
            other => unreachable!("{other:?} has no parts"),
        }
    }

    /// Words of an expression without variables.
    fn constant_words(&self, handle: Handle<Expression>, words: &mut Vec<u32>) -> Result<()> {
        match &self.module.global_expressions[handle] {
            Expression::Literal(literal) => words.push(literal_word(*literal)?),
            Expression::Constant(constant) => match self.constants.get(constant.index()) {
                Some(known) => words.extend_from_slice(known),
                None => self.constant_words(self.module.constants[*constant].init, words)?,
            },
            Expression::ZeroValue(ty) => {
                words.resize(words.len() + self.words(&self.module.types[*ty].inner)?, 0);
            }
            Expression::Compose { components, .. } => {
                for component in components {
                    self.constant_words(*component, words)?;
                }
            }
            other => bail!("a constant by {other:?}"),
        }
        Ok(())
    }

    /// The global variables with their memories, in their order.
    pub fn globals(&self) -> impl Iterator<Item = (&'m GlobalVariable, usize)> {
        self.module.global_variables.iter().map(|(handle, variable)| (variable, handle.index() + 1))
    }

    /// How many words a private variable has; 0 of what is bound.
    pub fn private_words(&self, variable: &GlobalVariable) -> Result<usize> {
        match variable.space {
            AddressSpace::Private => self.words(&self.module.types[variable.ty].inner),
            _ => Ok(0),
        }
    }
}

/// The word of a literal.
///
/// # Errors
/// Where it is not of 32 bits.
pub fn literal_word(literal: Literal) -> Result<u32> {
    Ok(match literal {
        Literal::F32(x) => x.to_bits(),
        Literal::U32(x) => x,
        Literal::I32(x) => x as u32,
        Literal::Bool(x) => u32::from(x),
        other => bail!("a literal {other:?}"),
    })
}

/// Adds the numbers of the functions that a block calls.
fn calls(block: &Block, called: &mut Vec<usize>) {
    for statement in block.iter() {
        match statement {
            Statement::Call { function, .. } => called.push(function.index()),
            Statement::Block(block) => calls(block, called),
            Statement::If { accept, reject, .. } => {
                calls(accept, called);
                calls(reject, called);
            }
            Statement::Loop { body, continuing, .. } => {
                calls(body, called);
                calls(continuing, called);
            }
            _ => {}
        }
    }
}

/// Whether there is something to run an expression with.
fn ensure_can_be_run(expression: &Expression) -> Result<()> {
    match expression {
        Expression::Literal(literal) => {
            literal_word(*literal)?;
        }
        Expression::Math { fun, .. } => {
            use MathFunction::*;
            let known = [Abs, Min, Max, Clamp, Floor, Ceil, Sqrt, Dot, Cross, Transpose, Mix];
            ensure!(known.contains(fun), "the function {fun:?} is not one of those that can be run: {known:?}");
        }
        Expression::Binary { op: BinaryOperator::Modulo, .. }
        | Expression::Constant(_)
        | Expression::ZeroValue(_)
        | Expression::Compose { .. }
        | Expression::Access { .. }
        | Expression::AccessIndex { .. }
        | Expression::Splat { .. }
        | Expression::Swizzle { .. }
        | Expression::FunctionArgument(_)
        | Expression::GlobalVariable(_)
        | Expression::LocalVariable(_)
        | Expression::Load { .. }
        | Expression::Unary { .. }
        | Expression::Binary { .. }
        | Expression::Select { .. }
        | Expression::Relational { .. }
        | Expression::As { .. }
        | Expression::CallResult(_) => {}
        other => bail!("the expression {other:?} cannot be run"),
    }
    Ok(())
}
