//! From text to trees.

use std::collections::HashMap;

use shapeloom_core::Aabb;

use super::bind::Argument;
use super::calls::Call;
use super::error::{Fault, TextError, TextProblem, line_of, shortened};
use super::foreign::Resolver;
use super::names::unknown;
use super::tokens::{Placed, Token, Tokens};
use super::value::{Infix, PREFIX, Value, infix, prefix};
use crate::tree::Tree;

/// What a text says.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// The shape.
    pub tree: Tree,
    /// Where to look for its surface, if the text says so.
    pub bounds: Option<Aabb>,
}

/// The most operations, arguments and open parentheses that a text may have: as many as a program may have steps.
const MOST: usize = 1 << 21;

/// Reads a text of the language.
///
/// Time and memory are in proportion to the text; nesting takes no stack. `resolver` is asked for functions with text
/// as their first argument that the language does not have.
///
/// # Errors
/// The first thing that is wrong, with its line and column. Parameters are checked as
/// [`Operation::check`](crate::Operation::check) does.
pub fn parse(text: &[u8], resolver: Option<&dyn Resolver>) -> Result<Parsed, TextError> {
    counted(text, resolver).map(|(parsed, _)| parsed)
}

/// The same with the number of turns of the parser's loops.
pub(super) fn counted(text: &[u8], resolver: Option<&dyn Resolver>) -> Result<(Parsed, usize), TextError> {
    let utf8 = std::str::from_utf8(text).map_err(|error| {
        let at = error.valid_up_to();
        Fault::new(at, TextProblem::Encoding { byte: text.get(at).copied().unwrap_or_default() }).within(text)
    })?;
    // A byte order mark, as some editors write it, says nothing.
    let start = if utf8.starts_with('\u{FEFF}') { '\u{FEFF}'.len_utf8() } else { 0 };
    let run = || -> Result<(Parsed, usize), Fault> {
        let mut parser = Parser::new(utf8, start, resolver)?;
        let parsed = parser.file()?;
        Ok((parsed, parser.turns))
    };
    run().map_err(|fault| fault.within(text))
}

/// What was begun and is not complete.
pub(super) enum Mark<'a> {
    Prefix(char, usize),
    Infix(Infix, usize),
    Group,
    Call(Box<Call<'a>>),
}

struct Definition {
    value: Value,
    at: usize,
}

pub(super) struct Parser<'a, 'r> {
    text: &'a str,
    tokens: Tokens<'a>,
    pub(super) current: Placed<'a>,
    pub(super) next: Placed<'a>,
    pub(super) values: Vec<Value>,
    pub(super) marks: Vec<Mark<'a>>,
    names: HashMap<&'a str, Definition>,
    pub(super) foreign: HashMap<String, Tree>,
    pub(super) resolver: Option<&'r dyn Resolver>,
    coordinates: [Tree; 3],
    /// The definition that is being read and the byte at which it begins.
    inside: &'a str,
    inside_at: usize,
    count: usize,
    turns: usize,
}

impl<'a, 'r> Parser<'a, 'r> {
    fn new(text: &'a str, start: usize, resolver: Option<&'r dyn Resolver>) -> Result<Self, Fault> {
        let mut tokens = Tokens::new(text, start);
        Ok(Self {
            text,
            current: tokens.next()?,
            next: tokens.next()?,
            tokens,
            values: Vec::new(),
            marks: Vec::new(),
            names: HashMap::new(),
            foreign: HashMap::new(),
            resolver,
            coordinates: [Tree::x(), Tree::y(), Tree::z()],
            inside: "",
            inside_at: 0,
            count: 0,
            turns: 0,
        })
    }

    pub(super) fn advance(&mut self) -> Result<(), Fault> {
        self.current = std::mem::replace(&mut self.next, self.tokens.next()?);
        Ok(())
    }

    pub(super) fn unexpected<T>(&self, expected: &str) -> Result<T, Fault> {
        Err(Fault::syntax(self.current.at, self.current.token.described(), expected))
    }

    fn file(&mut self) -> Result<Parsed, Fault> {
        let mut bounds = None;
        loop {
            let at = self.current.at;
            (self.inside, self.inside_at) = ("", at);
            match self.current.token {
                Token::End => return self.unexpected("a shape after the definitions"),
                Token::Name(name) if self.next.token.is('=') => {
                    self.definition(name, at)?;
                    continue;
                }
                _ => {}
            }
            match self.expression()? {
                Value::Bounds(_) if bounds.is_some() => {
                    return Err(Fault::syntax(at, "bounds a second time", "them once"));
                }
                Value::Bounds(region) => {
                    bounds = Some(region);
                    self.semicolon()?;
                }
                value => {
                    let found = value.described();
                    let Some(tree) = value.into_field() else {
                        return Err(Fault::syntax(at, found, "a shape"));
                    };
                    if self.current.token.is(';') {
                        self.advance()?;
                    }
                    return match self.current.token {
                        Token::End => Ok(Parsed { tree, bounds }),
                        _ => {
                            self.unexpected("the end after the shape: what comes before it are definitions, name = ...")
                        }
                    };
                }
            }
        }
    }

    fn semicolon(&mut self) -> Result<(), Fault> {
        match self.current.token.is(';') {
            true => self.advance(),
            false => self.unexpected("an operator or \";\""),
        }
    }

    fn definition(&mut self, name: &'a str, at: usize) -> Result<(), Fault> {
        let first = match self.names.get(name) {
            _ if is_reserved(name) => Some(0),
            Some(first) => Some(line_of(self.text.as_bytes(), first.at)),
            None => None,
        };
        if let Some(first) = first {
            return Err(Fault::new(at, TextProblem::Twice { name: shortened(name), first }));
        }
        (self.inside, self.inside_at) = (name, at);
        self.advance()?;
        self.advance()?;
        let value = match self.expression()?.closed() {
            Value::Field(tree) if !is_sharing(name) => {
                self.grow(at)?;
                Value::Field(tree.named(name))
            }
            other => other,
        };
        self.semicolon()?;
        self.names.insert(name, Definition { value, at });
        Ok(())
    }

    /// Counts an operation, an argument or a parenthesis.
    pub(super) fn grow(&mut self, at: usize) -> Result<(), Fault> {
        self.count += 1;
        if self.count > MOST { Err(Fault::new(at, TextProblem::TooLarge { most: MOST })) } else { Ok(()) }
    }

    pub(super) fn begin(&mut self, mark: Mark<'a>) -> Result<(), Fault> {
        self.grow(self.current.at)?;
        self.marks.push(mark);
        Ok(())
    }

    /// An expression up to what cannot belong to it.
    fn expression(&mut self) -> Result<Value, Fault> {
        let mut complete = false;
        loop {
            self.turns += 1;
            if !complete {
                complete = self.operand()?;
            } else {
                match self.continuation()? {
                    Some(still) => complete = still,
                    None => return self.values.pop().map_or_else(|| self.unexpected("a value"), Ok),
                }
            }
        }
    }

    /// What begins a value; whether it is one whole already.
    fn operand(&mut self) -> Result<bool, Fault> {
        let at = self.current.at;
        match std::mem::replace(&mut self.current.token, Token::End) {
            Token::Number(value) => self.values.push(Value::Number(value)),
            Token::Text(text) => self.values.push(Value::Text(text.into())),
            Token::Name(name) if self.next.token.is('(') => {
                self.advance()?;
                return self.begin_call(name, at, Vec::new());
            }
            Token::Name(name) => {
                let value = self.named(name, at)?;
                self.values.push(value);
            }
            Token::Sign('(') => {
                self.begin(Mark::Group)?;
                self.advance()?;
                return Ok(false);
            }
            Token::Sign(sign @ ('-' | '~')) => {
                self.begin(Mark::Prefix(sign, at))?;
                self.advance()?;
                return Ok(false);
            }
            other => {
                self.current.token = other;
                return self.unexpected("a number, a name or \"(\"");
            }
        }
        self.advance()?;
        Ok(true)
    }

    /// What follows a whole value: whether a whole value stands there again, or nothing at the expression's end.
    fn continuation(&mut self) -> Result<Option<bool>, Fault> {
        let at = self.current.at;
        if let Token::Sign(sign) = self.current.token
            && let Some(operator) = Infix::from_sign(sign)
        {
            self.reduce(operator.level() + u8::from(operator.groups_rightward()))?;
            self.begin(Mark::Infix(operator, at))?;
            self.advance()?;
            return Ok(Some(false));
        }
        match self.current.token {
            Token::Sign('.') => {
                self.advance()?;
                let Token::Name(name) = self.current.token else {
                    return self.unexpected("the name of a function");
                };
                let name_at = self.current.at;
                self.advance()?;
                if !self.current.token.is('(') {
                    return self.unexpected("\"(\"");
                }
                let receiver = self.values.pop().map(|value| Argument { name: None, value: value.closed(), at });
                self.begin_call(name, name_at, receiver.into_iter().collect()).map(Some)
            }
            Token::Name("deg") => match self.values.last_mut() {
                Some(Value::Number(value)) => {
                    *value = value.to_radians();
                    self.advance()?;
                    Ok(Some(true))
                }
                _ => self.unexpected("deg after numbers alone"),
            },
            Token::Sign(',') => {
                self.reduce(0)?;
                self.argument()?;
                self.advance()?;
                self.argument_name()?;
                Ok(Some(false))
            }
            Token::Sign(')') => {
                self.reduce(0)?;
                if matches!(self.marks.last(), Some(Mark::Group)) {
                    self.marks.pop();
                    let value = self.values.pop().map(Value::closed);
                    self.values.extend(value);
                    self.advance()?;
                    return Ok(Some(true));
                }
                self.argument()?;
                self.end_call()?;
                Ok(Some(true))
            }
            _ => {
                self.reduce(0)?;
                match (self.marks.last(), &self.current.token) {
                    (None, Token::End | Token::Sign(';')) => Ok(None),
                    (None, _) => self.unexpected("an operator or \";\""),
                    (Some(Mark::Call(_)), _) => self.unexpected("an operator, \",\" or \")\""),
                    (Some(_), _) => self.unexpected("an operator or \")\""),
                }
            }
        }
    }

    /// Carries out what binds at least so tightly and is begun last.
    fn reduce(&mut self, level: u8) -> Result<(), Fault> {
        loop {
            self.turns += 1;
            match self.marks.last() {
                Some(&Mark::Prefix(sign, at)) if PREFIX >= level => {
                    self.marks.pop();
                    if let Some(value) = self.values.pop() {
                        self.values.push(prefix(at, sign, value)?);
                    }
                }
                Some(&Mark::Infix(operator, at)) if operator.level() >= level => {
                    self.marks.pop();
                    if let (Some(right), Some(left)) = (self.values.pop(), self.values.pop()) {
                        self.values.push(infix(at, operator, left, right)?);
                    }
                }
                _ => return Ok(()),
            }
        }
    }

    /// The value of a name.
    fn named(&mut self, name: &'a str, at: usize) -> Result<Value, Fault> {
        Ok(match name {
            "x" => Value::Field(self.coordinates[0].clone()),
            "y" => Value::Field(self.coordinates[1].clone()),
            "z" => Value::Field(self.coordinates[2].clone()),
            "pi" => Value::Number(std::f64::consts::PI),
            _ => match self.names.get(name) {
                Some(definition) => definition.value.clone(),
                None => {
                    let known = self.names.keys().copied();
                    return Err(Fault::new(at, unknown(self.text, self.inside_at, self.inside, name, known)));
                }
            },
        })
    }
}

/// Words that cannot be defined.
pub(super) fn is_reserved(name: &str) -> bool {
    matches!(name, "x" | "y" | "z" | "pi" | "deg")
}

/// Whether a definition is for sharing alone and names no part.
pub(super) fn is_sharing(name: &str) -> bool {
    name.starts_with('_')
}
