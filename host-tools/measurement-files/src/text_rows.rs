//! The rows of a text table, one after the other, to a footer or the end.

use std::borrow::Cow;
use std::collections::VecDeque;

use crate::dialect::Kind;
use crate::excerpt::excerpt;
use crate::fault::{Fault, Place, PlacedFault};
use crate::layout::{Layout, is_comment};
use crate::lines::Lines;
use crate::reading::is_reading;
use crate::stamp::{DAY, Stamp};

/// Most lines of words behind a table that are no rows gone bad.
const LONGEST_FOOTER: usize = 3;

/// The rows of a text table that have not been read.
pub(crate) struct TextRows<'a> {
    pub layout: Layout,
    /// Fewest and most fields of a row.
    pub fields: (usize, usize),
    /// Lines that were read to find the table, from its first row on.
    pub head: VecDeque<String>,
    pub rest: Lines<'a>,
    /// Number of the line before the next, counted from 1.
    pub line: usize,
}

/// Turns time stamps into seconds since the first.
#[derive(Clone, Default)]
pub(crate) struct Clock {
    first: Option<i128>,
    last: i128,
}

impl Clock {
    pub fn seconds(&mut self, field: &str) -> Option<f64> {
        let stamp = Stamp::parse(field)?;
        let mut instant = stamp.nanoseconds;
        let first = *self.first.get_or_insert(instant);
        if !stamp.dated && self.last - instant > DAY / 2 {
            instant += ((self.last - instant) / DAY + 1) * DAY;
        }
        self.last = instant;
        Some((instant - first) as f64 / 1e9)
    }
}

impl TextRows<'_> {
    /// Reads as [`Table::rows`](crate::Table::rows) says.
    pub fn read(mut self, wanted: &[usize], holes: bool, visit: &mut dyn FnMut(&[f64])) -> Result<(), PlacedFault> {
        let stamps = |at: &usize| self.layout.kinds.get(*at) == Some(&Kind::Stamp);
        let mut clocks: Vec<Option<Clock>> = wanted.iter().map(|at| stamps(at).then(Clock::default)).collect();
        let mut row = vec![0.0; wanted.len()];
        let mut line = String::new();
        while self.next_into(&mut line)? {
            let mut fields = Vec::with_capacity(self.layout.kinds.len());
            self.layout.dialect.split(&line, &mut fields);
            match self.fill(&line, &fields, wanted, holes, &mut clocks, &mut row) {
                Ok(()) => visit(&row),
                Err(fault) => return self.end(&line, fault),
            }
        }
        Ok(())
    }

    fn next_into(&mut self, line: &mut String) -> Result<bool, Fault> {
        self.line += 1;
        match self.head.pop_front() {
            Some(next) => {
                *line = next;
                Ok(true)
            }
            None => self.rest.next_into(line),
        }
    }

    /// Reads one row.
    fn fill(
        &self,
        line: &str,
        fields: &[Cow<'_, str>],
        wanted: &[usize],
        holes: bool,
        clocks: &mut [Option<Clock>],
        row: &mut [f64],
    ) -> Result<(), Fault> {
        if line.trim().is_empty() {
            return Err(Fault::EmptyLine);
        }
        let filled = fields.iter().rposition(|field| !field.is_empty()).map_or(0, |last| last + 1);
        let (least, most) = self.fields;
        if fields.len() < least || filled > most {
            let expected = if fields.len() < least { least.max(self.layout.kinds.len()) } else { most };
            return Err(Fault::UnevenRow { found: fields.len(), expected });
        }
        let number = |at: &usize| fields.get(*at).and_then(|field| self.layout.dialect.number(field));
        let some = holes && wanted.iter().any(|at| number(at).is_some_and(is_reading));
        for (column, ((&at, clock), value)) in wanted.iter().zip(clocks).zip(row).enumerate() {
            let field = fields.get(at).map_or("", |field| field);
            if some && clock.is_none() {
                *value = number(&at).filter(|&value| is_reading(value)).unwrap_or(f64::NAN);
                continue;
            }
            *value = match clock {
                Some(clock) => clock.seconds(field),
                None => self.layout.dialect.number(field),
            }
            .ok_or_else(|| match field {
                "" => Fault::MissingField { column },
                _ => Fault::NotANumber { column, value: excerpt(field) },
            })?;
            if !is_reading(*value) {
                return Err(Fault::NotFinite { column, value: excerpt(field) });
            }
        }
        Ok(())
    }

    /// The end of the table at a line that is no row: the end of the file if only a footer follows, a few lines of
    /// words, none of them a row cut short or as wide as one.
    fn end(mut self, line: &str, fault: Fault) -> Result<(), PlacedFault> {
        let place = Place::Line(self.line);
        let (mut next, mut words) = (line.to_owned(), 0);
        loop {
            words += usize::from(!next.trim().is_empty() && !is_comment(&next));
            if words > LONGEST_FOOTER || self.is_row(&next) {
                return Err(fault.at(place));
            }
            if !self.next_into(&mut next)? {
                return Ok(());
            }
        }
    }

    /// Whether a line has a number, or words in the place of each.
    fn is_row(&self, line: &str) -> bool {
        let mut fields = Vec::new();
        self.layout.dialect.split(line, &mut fields);
        let as_wide = fields.len() == self.layout.kinds.len() && !is_comment(line) && !line.trim().is_empty();
        as_wide || fields.iter().any(|field| self.layout.dialect.kind(field).is_numeric())
    }
}
