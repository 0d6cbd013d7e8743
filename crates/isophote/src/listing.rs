//! Model files by name, by directory and by pattern: what a command that takes many files runs over.

use formats::FORMATS;
use std::path::Path;

/// A file that was asked for, or what stands in its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// The path, or the name of a built-in model.
    pub name: String,
    /// Why there is none: a directory that holds no model or cannot be read, a pattern that nothing matches.
    pub fault: Option<String>,
}

/// Whether these arguments ask for more than one file, or for a directory or pattern that may hold one or none.
pub fn is_many(arguments: &[String]) -> bool {
    let is_list = |argument: &String| Path::new(argument).is_dir() || is_pattern(argument);
    arguments.len() != 1 || arguments.iter().any(is_list)
}

/// The files of all arguments, in order: a name as it stands; a directory for the files in it whose extension is that of a
/// format, its directories among them, sorted; a pattern, in which `*` and `?` stand for parts of names, for what it matches.
///
/// Links to directories are not followed, so that a walk ends.
pub fn listed(arguments: &[String]) -> Vec<Listed> {
    let mut all = vec![];
    for argument in arguments {
        let path = Path::new(argument);
        if path.is_dir() {
            directory(path, &mut all);
        } else if is_pattern(argument) && !path.exists() {
            let found = matching(argument);
            if found.is_empty() {
                all.push(Listed { name: argument.clone(), fault: Some("no file matches".to_owned()) });
            }
            for name in found {
                if Path::new(&name).is_dir() { directory(Path::new(&name), &mut all) } else { all.push(file(name)) }
            }
        } else {
            all.push(file(argument.clone()));
        }
    }
    all
}

fn file(name: String) -> Listed {
    Listed { name, fault: None }
}

/// Adds the model files below a directory.
fn directory(root: &Path, all: &mut Vec<Listed>) {
    let before = all.len();
    let mut open = vec![root.to_owned()];
    let mut found = vec![];
    while let Some(folder) = open.pop() {
        let entries = match std::fs::read_dir(&folder) {
            Ok(entries) => entries,
            Err(error) => {
                found.push(Listed { name: folder.display().to_string(), fault: Some(error.to_string()) });
                continue;
            }
        };
        for entry in entries.filter_map(Result::ok) {
            let path = entry.path();
            let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
            if is_folder {
                open.push(path);
            } else if is_model(&path) && !path.is_dir() {
                found.push(file(path.display().to_string()));
            }
        }
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    all.extend(found);
    if all.len() == before {
        let known: Vec<&str> = FORMATS.iter().flat_map(|format| format.extensions()).copied().collect();
        let fault = format!("it holds no model file (.{})", known.join(", ."));
        all.push(Listed { name: root.display().to_string(), fault: Some(fault) });
    }
}

fn is_model(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    extension.is_some_and(|own| FORMATS.iter().any(|format| format.extensions().contains(&own.as_str())))
}

fn is_pattern(text: &str) -> bool {
    text.contains(['*', '?'])
}

/// The paths that a pattern matches, sorted: part by part, so that a star never runs over a separator.
fn matching(pattern: &str) -> Vec<String> {
    let start = if pattern.starts_with('/') { "/" } else { "" };
    let mut found = vec![start.to_owned()];
    for part in pattern.split('/').filter(|part| !part.is_empty()) {
        let longer = |path: &String, name: &str| match path.as_str() {
            "" | "/" => format!("{path}{name}"),
            _ => format!("{path}/{name}"),
        };
        let mut next = vec![];
        for path in &found {
            if !is_pattern(part) {
                next.extend(Some(longer(path, part)).filter(|path| Path::new(path).exists()));
                continue;
            }
            let folder = if path.is_empty() { "." } else { path };
            let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
            let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
            // As in a shell, a star begins no hidden name.
            let matches = |name: &String| name.starts_with('.') == part.starts_with('.') && is_match(part, name);
            next.extend(names.filter(matches).map(|name| longer(path, &name)));
        }
        found = next;
    }
    found.sort();
    found
}

/// Whether a name matches a pattern: `?` is one character, `*` any number of them.
fn is_match(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    // The last star, and where what it stands for ends: each step goes on in the pattern, or lengthens that.
    let (mut p, mut n, mut star) = (0, 0, None);
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => {
                star = Some((p, n));
                p += 1;
            }
            Some(c) if *c == '?' || *c == name[n] => {
                (p, n) = (p + 1, n + 1);
            }
            _ => match star {
                Some((at, end)) => {
                    star = Some((at, end + 1));
                    (p, n) = (at + 1, end + 1);
                }
                None => return false,
            },
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

#[cfg(test)]
mod tests {
    use super::is_match;

    #[test]
    fn stars_stand_for_any_part_of_a_name_and_question_marks_for_one_character() {
        for (pattern, name) in
            [("*", ""), ("*.step", "a.step"), ("w*g.??t", "wing.bpt"), ("*a*a*", "banana"), ("ä?", "äö")]
        {
            assert!(is_match(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in [("", "a"), ("*.step", "a.stp"), ("?", ""), ("a*b", "abc"), ("*a*a*a*a", "banana")] {
            assert!(!is_match(pattern, name), "{pattern} {name}");
        }
    }
}
