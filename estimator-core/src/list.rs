//! A short list of numbers of a parameter table: up to `N`, in place, `Copy`, and constructible in a `const`.

use crate::math::Real;
use core::fmt;
use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeSeq;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Up to `N` numbers. What lies behind the last one is 0.
#[derive(Clone, Copy, PartialEq)]
pub struct List<const N: usize, T = f32> {
    length: usize,
    values: [T; N],
}

impl<const N: usize> List<N> {
    /// The numbers of an array that is not longer than the list. In a `const` a longer one does not compile.
    ///
    /// # Panics
    /// The array is longer than `N`.
    pub const fn of<const M: usize>(numbers: [f32; M]) -> Self {
        assert!(M <= N, "more numbers than the list holds");
        let mut values = [0.0; N];
        let mut index = 0;
        while index < M {
            values[index] = numbers[index];
            index += 1;
        }
        Self { length: M, values }
    }
}

impl<const N: usize, T: Real> List<N, T> {
    /// The first `N` numbers of an iterator, or `None` when it has more.
    pub fn collect(numbers: impl IntoIterator<Item = T>) -> Option<Self> {
        let mut list = Self { length: 0, values: [T::zero(); N] };
        for number in numbers {
            *list.values.get_mut(list.length)? = number;
            list.length += 1;
        }
        Some(list)
    }

    /// The list in another number type.
    pub fn map<U: Real>(&self, number: impl Fn(T) -> U) -> List<N, U> {
        let mut values = [U::zero(); N];
        for (to, &from) in values.iter_mut().zip(self.iter()) {
            *to = number(from);
        }
        List { length: self.length, values }
    }
}

impl<const N: usize, T> core::ops::Deref for List<N, T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        // Never longer than the array: nothing else sets the length.
        self.values.get(..self.length).unwrap_or(&self.values)
    }
}

/// As a Rust expression.
impl<const N: usize, T: fmt::Debug> fmt::Debug for List<N, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("List::of").field(&&**self).finish()
    }
}

impl<const N: usize> Serialize for List<N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut sequence = serializer.serialize_seq(Some(self.length))?;
        self.iter().try_for_each(|number| sequence.serialize_element(number))?;
        sequence.end()
    }
}

impl<'de, const N: usize> Deserialize<'de> for List<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Numbers::<N>)
    }
}

struct Numbers<const N: usize>;

impl<'de, const N: usize> Visitor<'de> for Numbers<N> {
    type Value = List<N>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "at most {N} numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<List<N>, A::Error> {
        let mut list = List { length: 0, values: [0.0; N] };
        while let Some(number) = sequence.next_element()? {
            let place = list.values.get_mut(list.length).ok_or_else(|| A::Error::invalid_length(N + 1, &self))?;
            *place = number;
            list.length += 1;
        }
        Ok(list)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn survives_the_wire_and_refuses_what_is_too_long() {
        let list: List<4> = List::of([1.0, -2.5]);
        let mut buffer = [0; 64];
        let bytes = postcard::to_slice(&list, &mut buffer).unwrap();
        assert_eq!(postcard::from_bytes::<List<4>>(bytes), Ok(list));
        assert!(postcard::from_bytes::<List<1>>(bytes).is_err());
        assert_eq!((&list[..], List::<4>::collect([0.0; 5])), (&[1.0, -2.5][..], None));
        assert_eq!(format!("{list:?}"), "List::of([1.0, -2.5])");
    }
}
