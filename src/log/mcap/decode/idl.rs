//! Schemas in IDL, `ros2idl`, as far as ROS writes it: each type behind a line of `=` and a line `IDL: package/msg/Name`.

use std::{collections::BTreeMap, iter::Peekable, vec::IntoIter};

use super::definition::{Base, Count, Definitions, Field, Scalar, short};

/// Reads a schema; the words are what can't be read.
pub(super) fn parse(text: &str) -> Result<Definitions, String> {
    let tokens = tokens(text).into_iter().peekable();
    let definitions = Definitions::default();
    let mut parser = Parser { tokens, modules: Vec::new(), definitions, aliases: BTreeMap::new() };
    parser.scope()?;
    match parser.tokens.next() {
        None => Ok(parser.definitions),
        Some(token) => Err(format!("`{token}` stands where nothing can")),
    }
}

/// Words, numbers and single signs; without comments, annotations, preprocessor lines and the lines between types.
fn tokens(text: &str) -> Vec<String> {
    let mut plain = String::with_capacity(text.len());
    for line in text.lines() {
        let start = line.trim_start();
        let rule = start.len() >= 3 && start.bytes().all(|byte| byte == b'=');
        if !(rule || start.starts_with('#') || start.starts_with("IDL:")) {
            plain.push_str(line);
        }
        plain.push('\n');
    }
    let mut tokens = Vec::new();
    let mut rest = plain.as_str();
    loop {
        rest = rest.trim_start();
        let Some(first) = rest.chars().next() else { return tokens };
        let length = match first {
            '/' if rest.starts_with("/*") => {
                rest = rest.find("*/").and_then(|end| rest.get(end + 2..)).unwrap_or_default();
                continue;
            }
            '/' if rest.starts_with("//") => {
                rest = rest.find('\n').and_then(|end| rest.get(end..)).unwrap_or_default();
                continue;
            }
            '"' => quoted(rest),
            ':' if rest.starts_with("::") => 2,
            c if is_word(c) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
            c => c.len_utf8(),
        };
        let (token, behind) = rest.split_at_checked(length).unwrap_or((rest, ""));
        tokens.push(token.to_owned());
        rest = behind;
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '+')
}

/// Length of a text in quotes.
fn quoted(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return at + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}

struct Parser {
    tokens: Peekable<IntoIter<String>>,
    modules: Vec<String>,
    definitions: Definitions,
    /// What `typedef` has named.
    aliases: BTreeMap<String, (Base, Count)>,
}

impl Parser {
    fn next(&mut self) -> Result<String, String> {
        self.tokens.next().ok_or_else(|| "it ends early".to_owned())
    }

    fn is_next(&mut self, token: &str) -> bool {
        self.tokens.next_if(|next| next == token).is_some()
    }

    fn expect(&mut self, token: &str) -> Result<(), String> {
        let next = self.next()?;
        if next == token { Ok(()) } else { Err(format!("`{next}` stands where `{token}` has to")) }
    }

    /// What is between the braces of a module, or in the whole text.
    fn scope(&mut self) -> Result<(), String> {
        // Modules are counted, not nested calls: a text of braces alone must not exhaust the stack.
        while let Some(token) = self.tokens.peek().cloned() {
            match token.as_str() {
                "}" if !self.modules.is_empty() => {
                    self.tokens.next();
                    self.is_next(";");
                    self.modules.pop();
                    continue;
                }
                "}" => return Ok(()),
                _ => {}
            }
            self.tokens.next();
            match token.as_str() {
                "@" => self.annotation()?,
                "module" => {
                    let name = self.next()?;
                    self.expect("{")?;
                    self.modules.push(name);
                }
                "struct" => self.structure()?,
                "typedef" => self.alias()?,
                "enum" => {
                    let name = self.next()?;
                    self.until(";")?;
                    self.aliases.insert(name, (Base::Scalar(Scalar::U32), Count::One));
                }
                "const" => self.until(";")?,
                ";" => {}
                other => return Err(format!("`{other}` is not known")),
            }
        }
        if self.modules.is_empty() { Ok(()) } else { Err("it ends within a module".to_owned()) }
    }

    /// Passes over everything up to a sign.
    fn until(&mut self, sign: &str) -> Result<(), String> {
        while self.next()? != sign {}
        Ok(())
    }

    /// Passes over an annotation, its `@` used up.
    fn annotation(&mut self) -> Result<(), String> {
        self.next()?;
        if !self.is_next("(") {
            return Ok(());
        }
        let mut depth = 1;
        while depth > 0 {
            match self.next()?.as_str() {
                "(" => depth += 1,
                ")" => depth -= 1,
                _ => {}
            }
        }
        Ok(())
    }

    fn structure(&mut self) -> Result<(), String> {
        let name = self.next()?;
        self.expect("{")?;
        let mut fields = Vec::new();
        while !self.is_next("}") {
            if self.is_next("@") {
                self.annotation()?;
                continue;
            }
            let (base, count) = self.kind()?;
            let (name, count) = self.declared(count)?;
            fields.push(Field { name, base, count });
        }
        self.is_next(";");
        let full = self.modules.iter().map(String::as_str).chain([name.as_str()]).collect::<Vec<_>>().join("/");
        self.definitions.0.insert(short(&full), fields);
        Ok(())
    }

    fn alias(&mut self) -> Result<(), String> {
        let (base, count) = self.kind()?;
        let (name, count) = self.declared(count)?;
        self.aliases.insert(name, (base, count));
        Ok(())
    }

    /// A name, how many there are of it, and the sign at the end.
    fn declared(&mut self, count: Count) -> Result<(String, Count), String> {
        let name = self.next()?;
        let mut count = count;
        while self.is_next("[") {
            let size: usize = self.next()?.parse().map_err(|_| format!("`{name}` has no size"))?;
            self.expect("]")?;
            count = match count {
                Count::One => Count::Fixed(size),
                Count::Fixed(more) => Count::Fixed(size.saturating_mul(more)),
                Count::Counted => return Err(format!("`{name}` is an array of sequences")),
            };
        }
        self.expect(";")?;
        Ok((name, count))
    }

    fn kind(&mut self) -> Result<(Base, Count), String> {
        if !self.is_next("sequence") {
            return self.element();
        }
        self.expect("<")?;
        let (base, count) = self.element()?;
        if self.is_next(",") {
            self.next()?;
        }
        self.expect(">")?;
        Ok(match count {
            Count::One => (base, Count::Counted),
            _ => (Base::Opaque("a sequence of arrays".to_owned()), Count::One),
        })
    }

    /// A type that is no sequence.
    fn element(&mut self) -> Result<(Base, Count), String> {
        let mut word = self.next()?;
        if matches!(word.as_str(), "string" | "wstring") && self.is_next("<") {
            self.until(">")?;
        }
        while (word.ends_with("unsigned") || word.ends_with("long"))
            && self.tokens.peek().is_some_and(|next| is_long(next))
        {
            word = format!("{word} {}", self.next()?);
        }
        while self.is_next("::") {
            word = format!("{word}/{}", self.next()?);
        }
        Ok(self.named(&word))
    }

    fn named(&self, word: &str) -> (Base, Count) {
        let scalar = match word {
            "boolean" | "octet" | "uint8" | "char" => Scalar::U8,
            "int8" => Scalar::I8,
            "uint16" | "unsigned short" => Scalar::U16,
            "int16" | "short" => Scalar::I16,
            "uint32" | "unsigned long" => Scalar::U32,
            "int32" | "long" => Scalar::I32,
            "uint64" | "unsigned long long" => Scalar::U64,
            "int64" | "long long" => Scalar::I64,
            "float" => Scalar::F32,
            "double" => Scalar::F64,
            "string" => return (Base::Text, Count::One),
            "wstring" | "wchar" | "long double" => return (Base::Opaque(word.to_owned()), Count::One),
            _ => {
                let last = word.rsplit('/').next().unwrap_or(word);
                return match self.aliases.get(last) {
                    Some((base, count)) => (base.clone(), *count),
                    None if word.contains('/') => (Base::Named(short(word)), Count::One),
                    None => {
                        let package = self.modules.first().map_or("", String::as_str);
                        (Base::Named(format!("{package}/{word}")), Count::One)
                    }
                };
            }
        };
        (Base::Scalar(scalar), Count::One)
    }
}

fn is_long(word: &str) -> bool {
    matches!(word, "short" | "long" | "double")
}
