//! What can be wrong with an input: every fault at once, each with its place and its remedy.

use std::fmt;

/// One fault of an input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Where it is, in the words of the input: `visits[3].position`.
    pub path: String,
    /// What is wrong, with the offending value.
    pub message: String,
    /// What the user can do about it.
    pub action: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {} ({})", self.path, self.message, self.action)
    }
}

/// An input that cannot be planned: all its faults, in the order of the input.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", .faults.iter().map(Fault::to_string).collect::<Vec<_>>().join("\n"))]
pub struct InvalidInput {
    /// Never empty.
    pub faults: Vec<Fault>,
}

/// Collects faults while an input is checked, so that all are reported together.
#[derive(Debug, Default)]
pub struct Faults(Vec<Fault>);

impl Faults {
    /// Notes one fault.
    pub fn add(&mut self, path: impl Into<String>, message: impl Into<String>, action: &str) {
        self.0.push(Fault { path: path.into(), message: message.into(), action: action.to_owned() });
    }

    /// Notes the faults of a part that was checked on its own.
    pub fn extend(&mut self, part: InvalidInput) {
        self.0.extend(part.faults);
    }

    /// Passes on what `result` holds if nothing was wrong, here or there.
    ///
    /// # Errors
    /// [`InvalidInput`] with every fault noted so far, and then those of `result`.
    pub fn with<T>(mut self, result: Result<T, InvalidInput>) -> Result<T, InvalidInput> {
        match result {
            Ok(value) => self.into_result(value),
            Err(error) => {
                self.extend(error);
                Err(InvalidInput { faults: self.0 })
            }
        }
    }

    /// Passes `value` on if nothing was wrong.
    ///
    /// # Errors
    /// [`InvalidInput`] with every fault noted so far.
    pub fn into_result<T>(self, value: T) -> Result<T, InvalidInput> {
        if self.0.is_empty() { Ok(value) } else { Err(InvalidInput { faults: self.0 }) }
    }
}
