//! Documents against an XML schema, as far as JUnit's uses the language: elements, sequences, choices, attributes and
//! patterns. A schema that uses anything else is a panic, so that nothing in it goes unchecked.

use quick_xml::Reader;
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use regex::Regex;
use std::collections::{BTreeMap, BTreeSet};

/// An element of a document.
#[derive(Debug)]
struct Node {
    name: String,
    attributes: BTreeMap<String, String>,
    children: Vec<Node>,
    /// All of its text, without that of its children.
    text: String,
}

/// A schema.
pub struct Schema {
    elements: BTreeMap<String, Type>,
    types: BTreeMap<String, Type>,
}

#[derive(Debug)]
enum Type {
    /// Text, that matches the pattern where there is one.
    Text(Option<Regex>),
    /// The name of another.
    Named(String),
    Complex {
        mixed: bool,
        content: Option<Particle>,
        /// Type, and whether it must be there.
        attributes: BTreeMap<String, (Type, bool)>,
    },
}

/// What may stand in an element, so many times.
#[derive(Debug)]
struct Particle {
    kind: Kind,
    least: usize,
    most: usize,
}

#[derive(Debug)]
enum Kind {
    /// An element of its own type, or of the one that the schema gives that name.
    Element(String, Option<Box<Type>>),
    Sequence(Vec<Particle>),
    Choice(Vec<Particle>),
}

/// Whether XML 1.0 has no way to hold a character.
fn illegal(c: char) -> bool {
    c < ' ' && !"\t\n\r".contains(c) || "\u{fffe}\u{ffff}".contains(c)
}

/// The document as a tree.
fn tree(text: &str) -> Result<Node, String> {
    let mut reader = Reader::from_str(text);
    let root = Node { name: String::new(), attributes: BTreeMap::new(), children: vec![], text: String::new() };
    let mut open = vec![root];
    loop {
        let place = reader.buffer_position();
        let wrong = |what: String| format!("byte {place}: {what}");
        let event = reader.read_event().map_err(|error| wrong(error.to_string()))?;
        let top = open.last_mut().expect("the root is never closed");
        match event {
            Event::Start(start) => open.push(node(&start).map_err(wrong)?),
            Event::Empty(start) => top.children.push(node(&start).map_err(wrong)?),
            Event::End(_) => {
                let done = open.pop().expect("the reader pairs ends with starts");
                open.last_mut().expect("the root is never closed").children.push(done);
            }
            Event::Text(text) => {
                if text.contains("]]>") {
                    return Err(wrong("]]> in text".to_owned()));
                }
                top.text.push_str(&text);
            }
            Event::CData(text) => top.text.push_str(&text),
            Event::GeneralRef(reference) => {
                let whole = format!("&{};", &*reference);
                top.text.push_str(&quick_xml::escape::unescape(&whole).map_err(|error| wrong(error.to_string()))?);
            }
            Event::Decl(_) | Event::Comment(_) => {}
            Event::PI(_) | Event::DocType(_) => return Err(wrong("neither is read here".to_owned())),
            Event::Eof => break,
        }
        if open.last().is_some_and(|top| top.text.contains(illegal)) {
            return Err(wrong("a character that XML cannot hold".to_owned()));
        }
    }
    match <[Node; 1]>::try_from(open) {
        Ok([root]) if root.children.len() == 1 && root.text.trim().is_empty() => {
            Ok(root.children.into_iter().next().expect("one"))
        }
        Ok(_) => Err("not one element".to_owned()),
        Err(open) => Err(format!("<{}> does not end", open.last().map_or("", |node| node.name.as_str()))),
    }
}

fn node(start: &BytesStart) -> Result<Node, String> {
    let mut attributes = BTreeMap::new();
    for attribute in start.attributes() {
        let attribute = attribute.map_err(|error| error.to_string())?;
        let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|error| error.to_string())?;
        // Where it is not written as a reference, `<` cannot stand in a value.
        if value.contains(illegal) || attribute.value.contains('<') {
            return Err(format!("a character that XML cannot hold in {value:?}"));
        }
        attributes.insert(attribute.key.as_ref().to_owned(), value.into_owned());
    }
    Ok(Node { name: start.name().as_ref().to_owned(), attributes, children: vec![], text: String::new() })
}

impl Schema {
    /// Reads a schema.
    pub fn read(text: &str) -> Self {
        let schema = tree(text).expect("the schema is XML");
        let mut read = Self { elements: BTreeMap::new(), types: BTreeMap::new() };
        for child in &schema.children {
            let name = child.attributes["name"].clone();
            match child.name.as_str() {
                "xs:element" => read.elements.insert(name, declared(child)),
                "xs:complexType" | "xs:simpleType" => read.types.insert(name, defined(child)),
                other => panic!("{other} is not understood"),
            };
        }
        read
    }

    /// What is wrong with a document; nothing where it is valid.
    pub fn complaints(&self, document: &[u8]) -> Vec<String> {
        let text = match std::str::from_utf8(document) {
            Ok(text) => text,
            Err(error) => return vec![error.to_string()],
        };
        let root = match tree(text) {
            Ok(root) => root,
            Err(error) => return vec![error],
        };
        let mut found = vec![];
        match self.elements.get(&root.name) {
            Some(kind) => self.check(&root, kind, &mut found),
            None => found.push(format!("<{}> is no element of the schema", root.name)),
        }
        found
    }

    fn check(&self, node: &Node, kind: &Type, found: &mut Vec<String>) {
        let name = &node.name;
        match kind {
            Type::Named(other) => self.check(node, &self.types[other], found),
            Type::Text(_) => {
                found.extend(node.children.first().map(|child| format!("<{}> in <{name}>", child.name)));
                found.extend(node.attributes.keys().next().map(|other| format!("{other} of <{name}>")));
                self.check_text(&node.text, kind, name, found);
            }
            Type::Complex { mixed, content, attributes } => {
                if !mixed && !node.text.trim().is_empty() {
                    found.push(format!("text in <{name}>: {}", node.text));
                }
                for (own, value) in &node.attributes {
                    match attributes.get(own) {
                        Some((kind, _)) => self.check_text(value, kind, &format!("{own} of <{name}>"), found),
                        None => found.push(format!("{own} of <{name}> is not in the schema")),
                    }
                }
                let absent =
                    |(own, (_, needed)): &(&String, &(Type, bool))| *needed && !node.attributes.contains_key(*own);
                found.extend(attributes.iter().filter(absent).map(|(own, _)| format!("<{name}> has no {own}")));
                let nothing = Particle { kind: Kind::Sequence(vec![]), least: 1, most: 1 };
                let content = content.as_ref().unwrap_or(&nothing);
                if !ends(content, &node.children, 0).contains(&node.children.len()) {
                    let names: Vec<&str> = node.children.iter().map(|child| child.name.as_str()).collect();
                    found.push(format!("<{name}> may not hold {names:?}"));
                }
                for child in &node.children {
                    match local(content, &child.name).or_else(|| self.elements.get(&child.name)) {
                        Some(kind) => self.check(child, kind, found),
                        None => found.push(format!("<{}> is no element of the schema", child.name)),
                    }
                }
            }
        }
    }

    fn check_text(&self, text: &str, kind: &Type, place: &str, found: &mut Vec<String>) {
        match kind {
            Type::Named(other) => self.check_text(text, &self.types[other], place, found),
            Type::Text(Some(pattern)) if !pattern.is_match(text) => {
                found.push(format!("{place} is {text:?}, which does not match {pattern}"));
            }
            Type::Text(_) => {}
            Type::Complex { .. } => panic!("{place}: an attribute has no content"),
        }
    }
}

/// The type of a declaration, of an element or an attribute.
fn declared(node: &Node) -> Type {
    match (node.attributes.get("type").map(String::as_str), &node.children[..]) {
        (Some("xs:string"), []) => Type::Text(None),
        (Some(name), []) => Type::Named(name.to_owned()),
        (None, [inner]) => defined(inner),
        _ => panic!("{node:?} is not understood"),
    }
}

fn defined(node: &Node) -> Type {
    if node.name == "xs:simpleType" {
        let [restriction] = &node.children[..] else { panic!("{node:?} is not understood") };
        let [pattern] = &restriction.children[..] else { panic!("{node:?} is not understood") };
        assert!(restriction.attributes["base"] == "xs:string" && pattern.name == "xs:pattern", "{node:?}");
        let whole = format!("^(?:{})$", pattern.attributes["value"]);
        return Type::Text(Some(Regex::new(&whole).expect("a pattern")));
    }
    assert_eq!(node.name, "xs:complexType");
    let (mut content, mut attributes) = (None, BTreeMap::new());
    for child in &node.children {
        if child.name == "xs:attribute" {
            let needed = child.attributes.get("use").is_some_and(|word| word == "required");
            attributes.insert(child.attributes["name"].clone(), (declared(child), needed));
        } else {
            content = Some(particle(child));
        }
    }
    let mixed = node.attributes.get("mixed").is_some_and(|word| word == "true");
    Type::Complex { mixed, content, attributes }
}

fn particle(node: &Node) -> Particle {
    let number = |name: &str| match node.attributes.get(name).map(String::as_str) {
        None => 1,
        Some("unbounded") => usize::MAX,
        Some(digits) => digits.parse().expect("a number"),
    };
    let inner = || node.children.iter().map(particle).collect();
    let kind = match node.name.as_str() {
        "xs:sequence" => Kind::Sequence(inner()),
        "xs:choice" => Kind::Choice(inner()),
        "xs:element" => match node.attributes.get("ref") {
            Some(name) => Kind::Element(name.clone(), None),
            None => Kind::Element(node.attributes["name"].clone(), Some(Box::new(declared(node)))),
        },
        other => panic!("{other} is not understood"),
    };
    Particle { kind, least: number("minOccurs"), most: number("maxOccurs") }
}

/// The type that a particle itself gives an element.
fn local<'a>(particle: &'a Particle, name: &str) -> Option<&'a Type> {
    match &particle.kind {
        Kind::Element(own, kind) => kind.as_deref().filter(|_| own == name),
        Kind::Sequence(inner) | Kind::Choice(inner) => inner.iter().find_map(|inner| local(inner, name)),
    }
}

/// Where, among `children`, what a particle allows may end when it begins at `start`.
fn ends(particle: &Particle, children: &[Node], start: usize) -> BTreeSet<usize> {
    let once = |from: usize| -> BTreeSet<usize> {
        match &particle.kind {
            Kind::Element(name, _) => {
                children.get(from).filter(|c| c.name == *name).map(|_| from + 1).into_iter().collect()
            }
            Kind::Choice(inner) => inner.iter().flat_map(|inner| ends(inner, children, from)).collect(),
            Kind::Sequence(inner) => inner.iter().fold(BTreeSet::from([from]), |places, inner| {
                places.into_iter().flat_map(|place| ends(inner, children, place)).collect()
            }),
        }
    };
    let mut places = BTreeSet::from([start]);
    let mut all = if particle.least == 0 { places.clone() } else { BTreeSet::new() };
    for count in 1..=particle.most.min(children.len().max(1)) {
        places = places.into_iter().flat_map(once).collect();
        if count >= particle.least {
            all.extend(&places);
        }
    }
    all
}
