//! The small language in which a claim says how it is recomputed: arithmetic, named functions, and other claims by their ids.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = power { ("*" | "/") power }
//! power   = ["-"] atom ["^" power]
//! atom    = number | name | name "(" [sum { "," sum }] ")" | "(" sum ")"
//! ```
//! A name is a constant (`pi`, `inf`), the id of a claim (letters, digits, underscores and points), or a word where a function asks
//! for one (`force(hunt2017, ...)`). The functions stand in [`super::functions`].

use super::functions::{self, Function};
use serde::Deserialize;
use std::collections::BTreeSet;

/// A parsed expression.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "String")]
pub struct Expression {
    /// As written.
    pub text: String,
    root: Node,
}

#[derive(Clone, Debug, PartialEq)]
enum Node {
    Number(f64),
    Claim(String),
    Negative(Box<Node>),
    Binary(char, Box<Node>, Box<Node>),
    /// A function of words first, numbers after them.
    Call(&'static Function, Vec<String>, Vec<Node>),
}

impl TryFrom<String> for Expression {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let mut parser = Parser { rest: &text };
        let root = parser.sum()?;
        match parser.rest.trim_start() {
            "" => Ok(Self { root, text }),
            rest => Err(format!("\"{text}\": nothing is expected at \"{rest}\"")),
        }
    }
}

impl Expression {
    /// The value, with `claim` giving the value of a claim by its id.
    pub fn evaluate(&self, claim: &dyn Fn(&str) -> f64) -> f64 {
        value(&self.root, claim)
    }

    /// The claims that it takes numbers from.
    pub fn claims(&self) -> BTreeSet<&str> {
        let mut found = BTreeSet::new();
        collect(&self.root, &mut found);
        found
    }
}

fn value(node: &Node, claim: &dyn Fn(&str) -> f64) -> f64 {
    match node {
        Node::Number(x) => *x,
        Node::Claim(id) => claim(id),
        Node::Negative(x) => -value(x, claim),
        Node::Binary(operator, a, b) => {
            let (a, b) = (value(a, claim), value(b, claim));
            match operator {
                '+' => a + b,
                '-' => a - b,
                '*' => a * b,
                '/' => a / b,
                _ => libm::pow(a, b),
            }
        }
        Node::Call(function, words, arguments) => {
            let numbers: Vec<f64> = arguments.iter().map(|x| value(x, claim)).collect();
            (function.evaluate)(words, &numbers)
        }
    }
}

fn collect<'a>(node: &'a Node, found: &mut BTreeSet<&'a str>) {
    match node {
        Node::Number(_) => {}
        Node::Claim(id) => {
            found.insert(id);
        }
        Node::Negative(x) => collect(x, found),
        Node::Binary(_, a, b) => {
            collect(a, found);
            collect(b, found);
        }
        Node::Call(_, _, arguments) => arguments.iter().for_each(|x| collect(x, found)),
    }
}

struct Parser<'a> {
    rest: &'a str,
}

impl<'a> Parser<'a> {
    fn sum(&mut self) -> Result<Node, String> {
        let mut left = self.product()?;
        while let Some(operator) = self.one_of("+-") {
            left = Node::Binary(operator, Box::new(left), Box::new(self.product()?));
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<Node, String> {
        let mut left = self.power()?;
        while let Some(operator) = self.one_of("*/") {
            left = Node::Binary(operator, Box::new(left), Box::new(self.power()?));
        }
        Ok(left)
    }

    fn power(&mut self) -> Result<Node, String> {
        if self.one_of("-").is_some() {
            return Ok(Node::Negative(Box::new(self.power()?)));
        }
        let base = self.atom()?;
        match self.one_of("^") {
            Some(operator) => Ok(Node::Binary(
                operator,
                Box::new(base),
                Box::new(self.power()?),
            )),
            None => Ok(base),
        }
    }

    fn atom(&mut self) -> Result<Node, String> {
        if self.one_of("(").is_some() {
            let inner = self.sum()?;
            return self.close().map(|()| inner);
        }
        if self
            .rest
            .trim_start()
            .starts_with(|c: char| c.is_ascii_digit())
        {
            return self.number();
        }
        let name = self.word().to_owned();
        self.named(name)
    }

    fn number(&mut self) -> Result<Node, String> {
        let number = self.token(|c, before| {
            c.is_ascii_digit() || c == '.' || c == 'e' || (c == '-' && before == Some('e'))
        });
        let value = number.parse().map(Node::Number);
        value.map_err(|_| format!("\"{number}\" is no number"))
    }

    fn named(&mut self, name: String) -> Result<Node, String> {
        if name.is_empty() {
            return Err(format!(
                "a number, a name or a bracket is expected at \"{}\"",
                self.rest
            ));
        }
        if self.one_of("(").is_some() {
            return self.call(&name);
        }
        Ok(match name.as_str() {
            "pi" => Node::Number(std::f64::consts::PI),
            "inf" => Node::Number(f64::INFINITY),
            _ => Node::Claim(name),
        })
    }

    /// The arguments of a function, whose opening bracket is read.
    fn call(&mut self, name: &str) -> Result<Node, String> {
        let function =
            functions::find(name).ok_or_else(|| format!("there is no function {name}"))?;
        let (mut words, mut numbers) = (Vec::new(), Vec::new());
        for place in 0..function.words + function.numbers {
            if place > 0 && self.one_of(",").is_none() {
                return Err(format!("{name} needs {}", function.signature()));
            }
            if place < function.words {
                words.push(self.word().to_owned());
            } else {
                numbers.push(self.sum()?);
            }
        }
        self.close()
            .map_err(|_| format!("{name} takes only {}", function.signature()))?;
        Ok(Node::Call(function, words, numbers))
    }

    fn close(&mut self) -> Result<(), String> {
        let closed = self.one_of(")").is_some();
        closed
            .then_some(())
            .ok_or_else(|| format!("a closing bracket is missing at \"{}\"", self.rest))
    }

    fn one_of(&mut self, characters: &str) -> Option<char> {
        let rest = self.rest.trim_start();
        let c = rest.chars().next().filter(|c| characters.contains(*c))?;
        self.rest = &rest[c.len_utf8()..];
        Some(c)
    }

    fn word(&mut self) -> &'a str {
        self.token(|c, _| c.is_ascii_alphanumeric() || c == '_' || c == '.')
    }

    /// The longest run of characters that a test, which sees the one before, accepts.
    fn token(&mut self, accepts: impl Fn(char, Option<char>) -> bool) -> &'a str {
        let rest = self.rest.trim_start();
        let mut before = None;
        let end = rest.find(|c| {
            let stop = !accepts(c, before);
            before = Some(c);
            stop
        });
        let (token, after) = rest.split_at(end.unwrap_or(rest.len()));
        self.rest = after;
        token
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        let e = Expression::try_from(text.to_owned()).unwrap_or_else(|why| panic!("{why}"));
        e.evaluate(&|id| if id == "eq5.b1" { 303.5 } else { f64::NAN })
    }

    #[test]
    fn arithmetic_binds_as_usual() {
        assert_eq!(value("1 + 2 * 3 - 4 / 2"), 5.0);
        assert_eq!(value("-2^2 + (1 - 3) * 2"), -8.0);
        assert_eq!(value("2^3^2"), 512.0);
        assert_eq!(value("1e-3 * 1000 - 1"), 0.0);
    }

    #[test]
    fn names_are_claims_constants_functions_or_words() {
        assert_eq!(value("eq5.b1 * 2"), 607.0);
        assert_eq!(value("f620(2, 1, 0, inf)"), value("pi"));
        assert_eq!(value("coefficient(new_published, b1, 10)"), 303.5);
        let e = Expression::try_from("percent_error(a.b, f620(eq5.b1, 1, 0, c))".to_owned());
        let claims: Vec<String> = e
            .unwrap()
            .claims()
            .iter()
            .map(ToString::to_string)
            .collect();
        assert_eq!(claims, ["a.b", "c", "eq5.b1"]);
    }

    #[test]
    fn what_is_no_expression_is_refused() {
        for text in [
            "1 +",
            "(1",
            "1 2",
            "nothing(1)",
            "sqrt(1, 2)",
            "sqrt()",
            "1e",
            "",
        ] {
            assert!(Expression::try_from(text.to_owned()).is_err(), "{text}");
        }
    }
}
