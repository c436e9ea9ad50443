//! What a decoded statement consists of: records and their parameters (ISO 10303-21, clauses 6 and 10).
//!
//! Parameters are asked for by what they should be; one that is something else is `None`, and the mapping says so.

use super::decode::upper_case;
use super::text;
use std::borrow::Cow;

/// A parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum Value<'a> {
    /// `#12`.
    Reference(u64),
    /// `12`; larger than 64 bits reads as a real.
    Integer(i64),
    /// `1.5`.
    Real(f64),
    /// `'..'`, still encoded.
    Text(&'a [u8]),
    /// `.NAME.`, without the dots.
    Enumeration(&'a [u8]),
    /// `"0A3F"`, without the quotes.
    Binary(&'a [u8]),
    /// `$`.
    Unset,
    /// `*`.
    Derived,
    /// `(..)`.
    List(Vec<Value<'a>>),
    /// `KEYWORD(..)`.
    Typed(Cow<'a, str>, Vec<Value<'a>>),
}

/// `KEYWORD(..)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Record<'a> {
    /// In upper case.
    pub keyword: Cow<'a, str>,
    /// The parameters.
    pub parameters: Vec<Value<'a>>,
}

/// An instance: one record, or several partial ones of a complex instance.
#[derive(Debug, Clone, PartialEq)]
pub struct Entity<'a> {
    /// The instance's number.
    pub id: u64,
    /// At least one.
    pub records: Vec<Record<'a>>,
}

impl<'a> Value<'a> {
    /// A number; a typed one such as `LENGTH_MEASURE(1.)` as well.
    pub fn real(&self) -> Option<f64> {
        match self {
            Self::Real(value) => Some(*value).filter(|v| v.is_finite()),
            Self::Integer(value) => Some(*value as f64),
            Self::Typed(_, inner) | Self::List(inner) if inner.len() == 1 => match &inner[0] {
                Self::Real(value) => Some(*value).filter(|v| v.is_finite()),
                Self::Integer(value) => Some(*value as f64),
                _ => None,
            },
            _ => None,
        }
    }

    /// An integer; a real that is one as well.
    pub fn integer(&self) -> Option<i64> {
        match self {
            Self::Integer(value) => Some(*value),
            Self::Real(value) if value.fract() == 0.0 && value.abs() < 9e15 => Some(*value as i64),
            _ => None,
        }
    }

    /// A reference.
    pub fn reference(&self) -> Option<u64> {
        match self {
            Self::Reference(id) => Some(*id),
            Self::Typed(_, inner) if inner.len() == 1 => match inner[0] {
                Self::Reference(id) => Some(id),
                _ => None,
            },
            _ => None,
        }
    }

    /// The elements of a list.
    pub fn list(&self) -> Option<&[Value<'a>]> {
        match self {
            Self::List(values) => Some(values),
            Self::Typed(_, values) if matches!(values.as_slice(), [Self::List(_)]) => values[0].list(),
            _ => None,
        }
    }

    /// The decoded string.
    pub fn text(&self) -> Option<String> {
        match self {
            Self::Text(raw) => Some(text::decode(raw)),
            Self::Typed(_, inner) => match inner.as_slice() {
                [Self::Text(raw)] => Some(text::decode(raw)),
                _ => None,
            },
            _ => None,
        }
    }

    /// The name of an enumeration in upper case.
    pub fn enumeration(&self) -> Option<Cow<'a, str>> {
        match self {
            Self::Enumeration(name) => Some(upper_case(name)),
            _ => None,
        }
    }

    /// `.T.` or `.F.`.
    pub fn logical(&self) -> Option<bool> {
        match &*self.enumeration()? {
            "T" | "TRUE" => Some(true),
            "F" | "FALSE" => Some(false),
            _ => None,
        }
    }
}

impl<'a> Record<'a> {
    /// Parameter `at`; `$` where there are fewer.
    pub fn get(&self, at: usize) -> &Value<'a> {
        self.parameters.get(at).unwrap_or(&Value::Unset)
    }
    /// Parameter `at` as a number.
    pub fn real(&self, at: usize) -> Option<f64> {
        self.get(at).real()
    }
    /// Parameter `at` as a reference.
    pub fn reference(&self, at: usize) -> Option<u64> {
        self.get(at).reference()
    }
    /// Parameter `at` as a list; empty where it is none.
    pub fn list(&self, at: usize) -> &[Value<'a>] {
        self.get(at).list().unwrap_or(&[])
    }
    /// The references in list `at`.
    pub fn references(&self, at: usize) -> Vec<u64> {
        self.list(at).iter().filter_map(Value::reference).collect()
    }
    /// Parameter `at` as a string; empty where it is none.
    pub fn text(&self, at: usize) -> String {
        self.get(at).text().unwrap_or_default()
    }
    /// Parameter `at` as a flag.
    pub fn logical(&self, at: usize) -> Option<bool> {
        self.get(at).logical()
    }
}

impl<'a> Entity<'a> {
    /// The first record; the only one of a simple instance.
    pub fn first(&self) -> &Record<'a> {
        &self.records[0]
    }

    /// The record with this keyword.
    pub fn record(&self, keyword: &str) -> Option<&Record<'a>> {
        self.records.iter().find(|record| record.keyword == keyword)
    }

    /// Whether there is a record with this keyword.
    pub fn is(&self, keyword: &str) -> bool {
        self.record(keyword).is_some()
    }

    /// The keyword; those of a complex instance joined by `+`.
    pub fn kind(&self) -> String {
        let keywords: Vec<&str> = self.records.iter().map(|r| &*r.keyword).collect();
        keywords.join("+")
    }
}
