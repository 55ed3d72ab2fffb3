//! Where registers and their fields lie. Each peripheral's file declares those that its model has by the
//! manual's names, and no other number of a place stands in the models; the tests of `described` compare them
//! with two independent descriptions.

/// Declares constants: of each register its offset, of each field its mask, by the field's bit or its lowest and
/// highest; a name that another register or field has already is said behind `as`. The same again, for tests
/// alone, as `LAYOUT`.
macro_rules! layout {
    ($($peripheral:literal {
        $($register:ident @ $offset:literal {
            $($field:ident $(as $manual:literal)? = $low:literal $(..= $high:literal)?),* $(,)?
        })*
    })*) => {
        $($(
            pub const $register: u32 = $offset;
            $(pub const $field: u32 = $crate::layout::layout!(@mask $low $($high)?);)*
        )*)*

        #[cfg(test)]
        pub const LAYOUT: &[$crate::layout::Peripheral] = &[$($crate::layout::Peripheral {
            name: $peripheral,
            registers: &[$($crate::layout::Register {
                name: stringify!($register),
                offset: $register,
                fields: &[$(($crate::layout::layout!(@name $field $($manual)?), $field)),*],
            }),*],
        }),*];
    };
    (@name $field:ident) => { stringify!($field) };
    (@name $field:ident $manual:literal) => { $manual };
    (@mask $bit:literal) => { 1 << $bit };
    (@mask $low:literal $high:literal) => { (u32::MAX >> (31 - $high)) & (u32::MAX << $low) };
}

pub(crate) use layout;

/// The value of a field in a register's.
pub const fn field(value: u32, mask: u32) -> u32 {
    (value & mask) >> mask.trailing_zeros()
}

/// A peripheral as a model has it.
#[cfg(test)]
pub struct Peripheral {
    /// The manual's name.
    pub name: &'static str,
    /// The registers that the model has, those of the manual that it lacks left out.
    pub registers: &'static [Register],
}

/// A register as a model has it.
#[cfg(test)]
pub struct Register {
    /// The manual's name.
    pub name: &'static str,
    /// Bytes from the peripheral's first register.
    pub offset: u32,
    /// Names and masks of its fields.
    pub fields: &'static [(&'static str, u32)],
}
