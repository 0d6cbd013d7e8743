//! The document as it stands in the file, before its numbers are judged.
//!
//! Read by seeds that share the path of the member being read, so that a message can name it; numbers go straight
//! into vectors, without a tree of JSON values between, so that memory stays in proportion to the file.

use crate::error::{Cause, FormatError, shorten};
use crate::place::Place;
use nurbs::MAX_DEGREE;
use scene::escaped;
use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Unexpected, Visitor};
use serde_json::error::Category;
use std::cell::RefCell;
use std::fmt;
use std::marker::PhantomData;

/// The value of `format`.
pub(super) const FORMAT: &str = "nurbs-neutral";

/// The value of `version`.
pub(super) const VERSION: u64 = 1;

/// Reads the whole text as one document.
pub(super) fn parse(text: &str, file: &str) -> Result<RawDocument, FormatError> {
    let path = Path::default();
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let document = Seed(&path, PhantomData).deserialize(&mut deserializer);
    document.and_then(|document| deserializer.end().map(|()| document)).map_err(|error| {
        let (line, column) = line_and_column(text, &error);
        let whole = error.to_string();
        // serde_json ends its messages with the place, which has fields of its own here.
        let message = shorten(whole.rsplit_once(" at line ").map_or(whole.as_str(), |(message, _)| message));
        let cause = match error.classify() {
            Category::Data => Cause::Kind(message),
            Category::Eof => Cause::Syntax { message, near: String::new() },
            Category::Syntax | Category::Io => Cause::Syntax { message, near: word_at(text, line, column) },
        };
        FormatError::new(file, Place::Text { line, column, member: path.text() }, cause)
    })
}

/// Where `error` is, both from 1. serde_json says column 0 of the next line for the end of a line.
fn line_and_column(text: &str, error: &serde_json::Error) -> (usize, usize) {
    match (error.line(), error.column()) {
        (line, 0) if line > 1 => (line - 1, text.split('\n').nth(line - 2).map_or(0, str::len) + 1),
        (line, column) => (line, column.max(1)),
    }
}

/// What stands at column `column` (in bytes, from 1; serde_json names the last byte it read): the word of which it is
/// a part, the character itself where that is a sign, the word before it where it is a blank.
fn word_at(text: &str, line: usize, column: usize) -> String {
    let line = text.split('\n').nth(line.saturating_sub(1)).unwrap_or_default();
    let mut at = column.saturating_sub(1).min(line.len());
    while !line.is_char_boundary(at) {
        at -= 1;
    }
    let inside = |c: char| c.is_alphanumeric() || "+-._".contains(c);
    let (before, after) = line.split_at(at);
    if let Some(sign) = after.chars().next().filter(|c| !inside(*c) && !c.is_whitespace()) {
        return escaped(&sign.to_string());
    }
    let start = before.char_indices().rev().take_while(|(_, c)| inside(*c)).last().map_or(at, |(i, _)| i);
    let end = at + after.find(|c| !inside(c)).unwrap_or(after.len());
    shorten(&line[start..end])
}

/// The path of the member being read. A step is added on the way in and taken back on the way out, unless reading
/// failed: then the path shows where.
#[derive(Default)]
pub(super) struct Path(RefCell<Vec<Step>>);

enum Step {
    Key(&'static str),
    Index(usize),
}

impl Path {
    fn text(&self) -> String {
        let mut text = String::new();
        for step in self.0.borrow().iter() {
            match step {
                Step::Key(key) if text.is_empty() => text.push_str(key),
                Step::Key(key) => text.extend([".", key]),
                Step::Index(index) => text.push_str(&format!("[{index}]")),
            }
        }
        if text.is_empty() { "the document".to_owned() } else { text }
    }

    fn within<T, E>(&self, step: Step, read: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
        self.0.borrow_mut().push(step);
        let item = read()?;
        self.0.borrow_mut().pop();
        Ok(item)
    }
}

/// Something that can be read at a path.
pub(super) trait Item: Sized {
    /// Reads it.
    fn read<'de, D: Deserializer<'de>>(path: &Path, deserializer: D) -> Result<Self, D::Error>;
}

struct Seed<'p, T>(&'p Path, PhantomData<T>);

impl<'de, T: Item> DeserializeSeed<'de> for Seed<'_, T> {
    type Value = T;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<T, D::Error> {
        T::read(self.0, deserializer)
    }
}

/// A whole number from 0: a count or an index. `3.0` counts as 3.
#[derive(Debug, Clone, Copy)]
pub(super) struct Count(pub usize);

impl Item for Count {
    fn read<'de, D: Deserializer<'de>>(_: &Path, deserializer: D) -> Result<Self, D::Error> {
        let expected = "a whole number from 0";
        deserializer.deserialize_u64(WholeVisitor { least: 0, greatest: usize::MAX as u64, expected }).map(Self)
    }
}

/// A degree, 1 to [`MAX_DEGREE`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Degree(pub usize);

impl Item for Degree {
    fn read<'de, D: Deserializer<'de>>(_: &Path, deserializer: D) -> Result<Self, D::Error> {
        let expected = "a degree from 1 to 15";
        deserializer.deserialize_u64(WholeVisitor { least: 1, greatest: MAX_DEGREE as u64, expected }).map(Self)
    }
}

/// The version that is read.
pub(super) struct Version;

impl Item for Version {
    fn read<'de, D: Deserializer<'de>>(_: &Path, deserializer: D) -> Result<Self, D::Error> {
        let version = WholeVisitor { least: VERSION, greatest: VERSION, expected: "version 1" };
        deserializer.deserialize_u64(version).map(|_| Self)
    }
}

struct WholeVisitor {
    least: u64,
    greatest: u64,
    expected: &'static str,
}

impl WholeVisitor {
    fn check<E: Error>(self, x: u64, found: Unexpected) -> Result<usize, E> {
        let legal = usize::try_from(x).ok().filter(|_| self.least <= x && x <= self.greatest);
        legal.ok_or_else(|| E::invalid_value(found, &self))
    }
}

impl Visitor<'_> for WholeVisitor {
    type Value = usize;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.expected)
    }

    fn visit_u64<E: Error>(self, x: u64) -> Result<usize, E> {
        self.check(x, Unexpected::Unsigned(x))
    }

    fn visit_i64<E: Error>(self, x: i64) -> Result<usize, E> {
        Err(E::invalid_value(Unexpected::Signed(x), &self))
    }

    fn visit_f64<E: Error>(self, x: f64) -> Result<usize, E> {
        // Whole numbers up to 2^53 are exact in f64; beyond, a count is no longer meant.
        let whole = x.trunc() == x && (0.0..=9_007_199_254_740_992.0).contains(&x);
        if whole {
            self.check(x as u64, Unexpected::Float(x))
        } else {
            Err(E::invalid_value(Unexpected::Float(x), &self))
        }
    }
}

/// The format that is read.
pub(super) struct Format;

impl Item for Format {
    fn read<'de, D: Deserializer<'de>>(_: &Path, deserializer: D) -> Result<Self, D::Error> {
        read_word(deserializer, &[(FORMAT, ())]).map(|()| Self)
    }
}

/// How many knots stand in the file for n points of degree p.
#[derive(Debug, Clone, Copy)]
pub(super) enum Convention {
    /// n + p + 1.
    Full,
    /// n + p − 1: the two superfluous end knots are left out.
    Short,
}

impl Item for Convention {
    fn read<'de, D: Deserializer<'de>>(_: &Path, deserializer: D) -> Result<Self, D::Error> {
        read_word(deserializer, &[("full", Self::Full), ("short", Self::Short)])
    }
}

/// The meaning of a string that is one of the given words.
fn read_word<'de, T: Copy, D: Deserializer<'de>>(deserializer: D, words: &[(&str, T)]) -> Result<T, D::Error> {
    let found = String::deserialize(deserializer)?;
    let meaning = words.iter().find(|(word, _)| *word == found).map(|&(_, meaning)| meaning);
    meaning.ok_or_else(|| {
        let expected: Vec<String> = words.iter().map(|(word, _)| format!("{word:?}")).collect();
        D::Error::invalid_value(Unexpected::Str(&found), &expected.join(" or ").as_str())
    })
}

/// Items that serde reads well by itself: one value, without members.
macro_rules! plain_item {
    ($($type:ty),*) => {
        $(impl Item for $type {
            fn read<'de, D: Deserializer<'de>>(_: &Path, deserializer: D) -> Result<Self, D::Error> {
                Self::deserialize(deserializer)
            }
        })*
    };
}

plain_item!(f64, bool, i64, String);

/// An item or null.
struct Maybe<T>(Option<T>);

impl<T: Item> Item for Maybe<T> {
    fn read<'de, D: Deserializer<'de>>(path: &Path, deserializer: D) -> Result<Self, D::Error> {
        struct MaybeVisitor<'p, T>(&'p Path, PhantomData<T>);
        impl<'de, T: Item> Visitor<'de> for MaybeVisitor<'_, T> {
            type Value = Maybe<T>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a value or null")
            }

            fn visit_none<E: Error>(self) -> Result<Maybe<T>, E> {
                Ok(Maybe(None))
            }

            fn visit_unit<E: Error>(self) -> Result<Maybe<T>, E> {
                Ok(Maybe(None))
            }

            fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<Maybe<T>, D::Error> {
                T::read(self.0, deserializer).map(|item| Maybe(Some(item)))
            }
        }
        deserializer.deserialize_option(MaybeVisitor(path, PhantomData))
    }
}

impl<T: Item> Item for Vec<T> {
    fn read<'de, D: Deserializer<'de>>(path: &Path, deserializer: D) -> Result<Self, D::Error> {
        struct ListVisitor<'p, T>(&'p Path, PhantomData<T>);
        impl<'de, T: Item> Visitor<'de> for ListVisitor<'_, T> {
            type Value = Vec<T>;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a list")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Vec<T>, A::Error> {
                let mut items = vec![];
                let next = |index, entries: &mut A| {
                    self.0.within(Step::Index(index), || entries.next_element_seed(Seed(self.0, PhantomData)))
                };
                while let Some(item) = next(items.len(), &mut entries)? {
                    items.push(item);
                }
                Ok(items)
            }
        }
        deserializer.deserialize_seq(ListVisitor(path, PhantomData))
    }
}

impl<T: Item, const N: usize> Item for [T; N] {
    fn read<'de, D: Deserializer<'de>>(path: &Path, deserializer: D) -> Result<Self, D::Error> {
        struct TupleVisitor<'p, T, const N: usize>(&'p Path, PhantomData<T>);
        impl<'de, T: Item, const N: usize> Visitor<'de> for TupleVisitor<'_, T, N> {
            type Value = [T; N];

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                write!(f, "a list of {N}")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<[T; N], A::Error> {
                let mut items = [const { None }; N];
                for (index, item) in items.iter_mut().enumerate() {
                    let read = || entries.next_element_seed(Seed(self.0, PhantomData));
                    *item = self.0.within(Step::Index(index), read)?;
                    if item.is_none() {
                        return Err(A::Error::invalid_length(index, &self));
                    }
                }
                if entries.next_element::<IgnoredAny>()?.is_some() {
                    return Err(A::Error::invalid_length(N + 1, &self));
                }
                Ok(items.map(|item| item.expect("each was read")))
            }
        }
        deserializer.deserialize_seq(TupleVisitor(path, PhantomData))
    }
}

/// An object as far as it has been read.
trait Partial: Default {
    type Whole;

    fn member<'de, A: MapAccess<'de>>(&mut self, key: &str, path: &Path, members: &mut A) -> Result<(), A::Error>;

    /// The object, or the key of a required member that was not there.
    fn finish(self) -> Result<Self::Whole, &'static str>;
}

fn read_object<'de, T: Partial, D: Deserializer<'de>>(path: &Path, deserializer: D) -> Result<T::Whole, D::Error> {
    struct ObjectVisitor<'p, T>(&'p Path, PhantomData<T>);
    impl<'de, T: Partial> Visitor<'de> for ObjectVisitor<'_, T> {
        type Value = T::Whole;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("an object")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<T::Whole, A::Error> {
            let mut object = T::default();
            while let Some(key) = members.next_key::<String>()? {
                object.member(&key, self.0, &mut members)?;
            }
            object.finish().or_else(|key| {
                self.0.within(Step::Key(key), || Err(A::Error::custom("the key is missing, or its value is null")))
            })
        }
    }
    deserializer.deserialize_map(ObjectVisitor::<T>(path, PhantomData))
}

fn read_member<'de, T: Item, A: MapAccess<'de>>(
    slot: &mut Option<T>,
    key: &'static str,
    path: &Path,
    members: &mut A,
) -> Result<(), A::Error> {
    path.within(Step::Key(key), || {
        if slot.is_some() {
            return Err(A::Error::custom("the key is given twice"));
        }
        *slot = members.next_value_seed(Seed::<Maybe<T>>(path, PhantomData))?.0;
        Ok(())
    })
}

macro_rules! object {
    ($(#[$doc:meta])* $name:ident {
        required { $($key:ident: $type:ty,)* }
        optional { $($optional_key:ident: $optional_type:ty,)* }
        ignored { $($ignored_key:ident,)* }
    }) => {
        $(#[$doc])*
        pub(super) struct $name {
            $(pub $key: $type,)*
            $(pub $optional_key: Option<$optional_type>,)*
        }

        impl Item for $name {
            fn read<'de, D: Deserializer<'de>>(path: &Path, deserializer: D) -> Result<Self, D::Error> {
                #[derive(Default)]
                struct Read {
                    $($key: Option<$type>,)*
                    $($optional_key: Option<$optional_type>,)*
                }

                impl Partial for Read {
                    type Whole = $name;

                    fn member<'de, A: MapAccess<'de>>(
                        &mut self,
                        key: &str,
                        path: &Path,
                        members: &mut A,
                    ) -> Result<(), A::Error> {
                        match key {
                            $(stringify!($key) => read_member(&mut self.$key, stringify!($key), path, members),)*
                            $(stringify!($optional_key) => {
                                read_member(&mut self.$optional_key, stringify!($optional_key), path, members)
                            })*
                            $(stringify!($ignored_key) => members.next_value::<IgnoredAny>().map(drop),)*
                            // A slip in a name must not pass for an absent member.
                            _ => Err(A::Error::custom(format_args!("there is no key \"{key}\" here"))),
                        }
                    }

                    fn finish(self) -> Result<$name, &'static str> {
                        Ok($name {
                            $($key: self.$key.ok_or(stringify!($key))?,)*
                            $($optional_key: self.$optional_key,)*
                        })
                    }
                }

                read_object::<Read, D>(path, deserializer)
            }
        }
    };
}

object! {
    /// The whole file.
    RawDocument {
        required {
            format: Format,
            version: Version,
            surfaces: Vec<RawSurface>,
        }
        optional {
            name: String,
            unit: RawUnit,
            knot_convention: Convention,
            faces: Vec<RawFace>,
        }
        ignored { view, meta, }
    }
}

object! {
    /// A unit of length.
    RawUnit {
        required {
            name: String,
            millimetres: f64,
        }
        optional {}
        ignored {}
    }
}

object! {
    /// A surface.
    RawSurface {
        required {
            degree: [Degree; 2],
            knots_u: Vec<f64>,
            knots_v: Vec<f64>,
            nu: Count,
            nv: Count,
            points: Vec<[f64; 3]>,
        }
        optional {
            weights: Vec<f64>,
            knot_convention: Convention,
            periodic: [bool; 2],
        }
        ignored {}
    }
}

object! {
    /// A face.
    RawFace {
        required {
            surface: Count,
        }
        optional {
            name: String,
            colour: String,
            kind: String,
            layers: Vec<String>,
            reversed: bool,
            tolerance: f64,
            edge_tolerance: f64,
            vertex_tolerance: f64,
            loops: Vec<RawLoop>,
        }
        ignored { pixel, }
    }
}

object! {
    /// A loop of trim curves.
    RawLoop {
        required {
            outer: bool,
            trims: Vec<RawTrim>,
        }
        optional {}
        ignored {}
    }
}

object! {
    /// A trim curve.
    RawTrim {
        required {
            degree: Degree,
            knots: Vec<f64>,
            points: Vec<[f64; 2]>,
        }
        optional {
            weights: Vec<f64>,
            knot_convention: Convention,
            reversed: bool,
            seam: bool,
            degenerate: bool,
            edge: i64,
            edge_tolerance: f64,
            vertex_tolerance: f64,
        }
        ignored {}
    }
}
