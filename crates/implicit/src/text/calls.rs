//! Calls while text is read.

use std::sync::Arc;

use super::bind::Argument;
use super::error::{Fault, TextProblem, shortened};
use super::foreign::{ForeignCall, ResolveError, Resolver};
use super::functions::Callee;
use super::names::nearest;
use super::parser::{Mark, Parser};
use super::tokens::Token;
use super::value::Value;
use crate::program::CompileError;
use crate::tree::Tree;

/// A call that is begun.
pub(super) struct Call<'a> {
    function: &'a str,
    at: usize,
    arguments: Vec<Argument<'a>>,
    /// The name and the place of the argument that is being read.
    name: Option<&'a str>,
    argument_at: usize,
}

impl<'a> Parser<'a, '_> {
    /// Begins a call; its opening parenthesis is the current token.
    pub(super) fn begin_call(
        &mut self,
        function: &'a str,
        at: usize,
        arguments: Vec<Argument<'a>>,
    ) -> Result<bool, Fault> {
        let call = Call { function, at, arguments, name: None, argument_at: at };
        self.begin(Mark::Call(Box::new(call)))?;
        self.advance()?;
        if self.current.token.is(')') {
            self.end_call()?;
            return Ok(true);
        }
        self.argument_name()?;
        Ok(false)
    }

    /// Reads `name:` before an argument, where there is one.
    pub(super) fn argument_name(&mut self) -> Result<(), Fault> {
        let at = self.current.at;
        let name = match self.current.token {
            Token::Name(name) if self.next.token.is(':') => {
                self.advance()?;
                self.advance()?;
                Some(name)
            }
            _ => None,
        };
        if let Some(Mark::Call(call)) = self.marks.last_mut() {
            if name.is_none() && call.arguments.last().is_some_and(|before| before.name.is_some()) {
                return self.unexpected("the name of a parameter, since the one before has one");
            }
            (call.name, call.argument_at) = (name, at);
        }
        Ok(())
    }

    /// Takes the last value as an argument of the call that is begun.
    pub(super) fn argument(&mut self) -> Result<(), Fault> {
        self.grow(self.current.at)?;
        match (self.marks.last_mut(), self.values.pop()) {
            (Some(Mark::Call(call)), Some(value)) => {
                call.arguments.push(Argument { name: call.name, value: value.closed(), at: call.argument_at });
                Ok(())
            }
            (Some(_), _) => self.unexpected("an operator or \")\""),
            (None, _) => self.unexpected("an operator or \";\""),
        }
    }

    /// Completes the call that is begun; its closing parenthesis is the current token.
    pub(super) fn end_call(&mut self) -> Result<(), Fault> {
        let Some(Mark::Call(call)) = self.marks.pop() else {
            return self.unexpected("an operator or \";\"");
        };
        let Call { function, at, arguments, .. } = *call;
        let value = match Callee::of(function) {
            Some(callee) => {
                let mut bound = callee.signature().bind(at, arguments)?;
                let fault = |error| Fault::new(at, TextProblem::Parameter(error));
                let value = callee.build(&mut bound).map_err(fault)?;
                if let Value::Field(tree) = &value
                    && let Err(CompileError::Parameter(error)) = tree.operation().check()
                {
                    return Err(fault(error));
                }
                value
            }
            None => Value::Field(self.foreign(function, at, arguments)?),
        };
        self.values.push(value);
        self.advance()
    }

    fn foreign(&mut self, function: &'a str, at: usize, arguments: Vec<Argument<'a>>) -> Result<Tree, Fault> {
        let mut arguments = arguments.into_iter();
        let (Some(Argument { value: Value::Text(argument), name: None, .. }), resolver) =
            (arguments.next(), self.resolver)
        else {
            return Err(self.unknown_function(function, at));
        };
        let mut call =
            ForeignCall { function: function.to_owned(), argument: argument.to_string(), numbers: Vec::new() };
        for argument in arguments {
            let found = argument.value.described().to_owned();
            match (argument.name, argument.value) {
                (Some(name), Value::Number(value)) if value.is_finite() && call.number(name).is_none() => {
                    call.numbers.push((name.to_owned(), value));
                }
                (name, _) => {
                    let of = function.to_owned();
                    let found = format!("{found} {}", name.unwrap_or("without a name"));
                    let expected = "finite numbers with different names after the text".to_owned();
                    return Err(Fault::new(argument.at, TextProblem::Argument { of, found, expected }));
                }
            }
        }
        let text = call.text();
        if let Some(known) = self.foreign.get(&text) {
            return Ok(known.clone());
        }
        let Some(resolver) = resolver else {
            return Err(Fault::new(at, TextProblem::NoResolver { call: shortened(&call.to_string()) }));
        };
        let tree = match resolver.resolve(&call) {
            Ok(resolved) => Tree::foreign(Arc::from(text.as_str()), resolved.field, resolved.exact),
            Err(ResolveError::UnknownFunction) => return Err(self.unknown_function(function, at)),
            Err(ResolveError::Failed { reason, category }) => {
                let call = shortened(&call.to_string());
                return Err(Fault::new(at, TextProblem::Foreign { call, reason, category }));
            }
        };
        self.foreign.insert(text, tree.clone());
        Ok(tree)
    }

    fn unknown_function(&self, function: &str, at: usize) -> Fault {
        let foreign = self.resolver.map(Resolver::functions).unwrap_or_default();
        let known = Callee::all().map(|callee| callee.signature().name).chain(foreign.iter().map(String::as_str));
        let nearest = nearest(function, known);
        Fault::new(at, TextProblem::UnknownFunction { name: shortened(function), nearest })
    }
}
