//! The form in which values are sent: little-endian, lengths before lists, fields in the order of their declaration.

use std::sync::Arc;

use crate::error::{Error, Kind, Place, Result};
use crate::platform::memory::reserved;

const WHAT: &str = "a message of another rank";

/// A value that can be sent. What is taken is what was put, bit by bit.
pub trait Wire: Sized {
    fn put(&self, to: &mut Vec<u8>);

    /// Takes the value from the begin of the bytes.
    fn take(from: &mut &[u8]) -> Result<Self>;

    /// Several values without their number.
    fn put_each(values: &[Self], to: &mut Vec<u8>) {
        values.iter().for_each(|value| value.put(to));
    }

    fn take_each(count: usize, from: &mut &[u8]) -> Result<Vec<Self>> {
        // no value but () takes no byte
        let mut all = reserved(count.min(from.len()), WHAT)?;
        for _ in 0..count {
            all.push(Self::take(from)?);
        }
        Ok(all)
    }
}

/// A message that consists of this value.
pub fn message(value: &impl Wire) -> Vec<u8> {
    let mut bytes = Vec::new();
    value.put(&mut bytes);
    bytes
}

/// The value of which a message consists.
pub fn value<T: Wire>(mut message: &[u8]) -> Result<T> {
    let value = T::take(&mut message)?;
    if message.is_empty() {
        Ok(value)
    } else {
        Err(damaged())
    }
}

pub fn damaged() -> Error {
    Error::new(Kind::Internal, "a message of another rank is damaged")
}

fn first<'a>(from: &mut &'a [u8], count: usize) -> Result<&'a [u8]> {
    let (own, rest) = from.split_at_checked(count).ok_or_else(damaged)?;
    *from = rest;
    Ok(own)
}

/// Numbers, sent as others with these conversions; many at once are copied.
macro_rules! wire_numbers {
    ($($number:ty as $sent:ty: $to:expr, $from:expr;)+) => {$(
        impl Wire for $number {
            fn put(&self, to: &mut Vec<u8>) {
                to.extend_from_slice(&<$sent>::to_le_bytes($to(*self)));
            }

            fn take(from: &mut &[u8]) -> Result<Self> {
                let bytes = first(from, size_of::<$sent>())?;
                $from(<$sent>::from_le_bytes(bytes.try_into().map_err(|_| damaged())?))
            }

            fn put_each(values: &[Self], to: &mut Vec<u8>) {
                let begin = to.len();
                to.resize(begin + values.len() * size_of::<$sent>(), 0);
                for (place, value) in to[begin..].chunks_exact_mut(size_of::<$sent>()).zip(values) {
                    place.copy_from_slice(&<$sent>::to_le_bytes($to(*value)));
                }
            }

            fn take_each(count: usize, from: &mut &[u8]) -> Result<Vec<Self>> {
                let bytes = first(from, count.checked_mul(size_of::<$sent>()).ok_or_else(damaged)?)?;
                let mut all = reserved(count, WHAT)?;
                for bytes in bytes.chunks_exact(size_of::<$sent>()) {
                    let mut own = [0; size_of::<$sent>()];
                    own.copy_from_slice(bytes);
                    all.push($from(<$sent>::from_le_bytes(own))?);
                }
                Ok(all)
            }
        }
    )+};
}

wire_numbers! {
    u8 as u8: |v| v, Ok;
    u32 as u32: |v| v, Ok;
    u64 as u64: |v| v, Ok;
    i32 as i32: |v| v, Ok;
    i64 as i64: |v| v, Ok;
    usize as u64: |v| v as u64, |v| usize::try_from(v).map_err(|_| damaged());
    f64 as f64: spoiled, |v| Ok(spoiled(v));
}

/// For tests: numbers that are put or taken during `work` are wrong in their last bit, on this thread.
#[cfg(feature = "loopback")]
pub fn spoiling<T>(work: impl FnOnce() -> T) -> T {
    SPOILS.set(true);
    let done = work();
    SPOILS.set(false);
    done
}

#[cfg(feature = "loopback")]
thread_local! {
    static SPOILS: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

#[cfg(feature = "loopback")]
fn spoiled(number: f64) -> f64 {
    f64::from_bits(number.to_bits() ^ u64::from(SPOILS.get()))
}

#[cfg(not(feature = "loopback"))]
fn spoiled(number: f64) -> f64 {
    number
}

/// Sends the fields of a struct, which must be all its fields.
macro_rules! wire_struct {
    ($name:ident { $($field:ident),+ $(,)? }) => {
        impl $crate::ranks::Wire for $name {
            fn put(&self, to: &mut Vec<u8>) {
                $($crate::ranks::Wire::put(&self.$field, to);)+
            }

            fn take(from: &mut &[u8]) -> $crate::error::Result<Self> {
                Ok(Self { $($field: $crate::ranks::Wire::take(from)?),+ })
            }
        }
    };
}
pub(crate) use wire_struct;

/// Sends a struct without fields.
macro_rules! wire_unit {
    ($($name:ident),+) => {$(
        impl $crate::ranks::Wire for $name {
            fn put(&self, _: &mut Vec<u8>) {}

            fn take(_: &mut &[u8]) -> $crate::error::Result<Self> {
                Ok(Self)
            }
        }
    )+};
}
pub(crate) use wire_unit;

/// Sends an enum without data as the number of its value.
macro_rules! wire_enum {
    ($name:ident { $($value:ident),+ $(,)? }) => {
        impl $crate::ranks::Wire for $name {
            fn put(&self, to: &mut Vec<u8>) {
                to.push(*self as u8);
            }

            fn take(from: &mut &[u8]) -> $crate::error::Result<Self> {
                let all = [$(Self::$value),+];
                let number: u8 = $crate::ranks::Wire::take(from)?;
                all.get(usize::from(number)).copied().ok_or_else($crate::ranks::damaged)
            }
        }
    };
}
pub(crate) use wire_enum;

impl Wire for () {
    fn put(&self, _: &mut Vec<u8>) {}

    fn take(_: &mut &[u8]) -> Result<Self> {
        Ok(())
    }
}

impl Wire for bool {
    fn put(&self, to: &mut Vec<u8>) {
        to.push(u8::from(*self));
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        match u8::take(from)? {
            0 => Ok(false),
            1 => Ok(true),
            _ => Err(damaged()),
        }
    }
}

impl<T: Wire> Wire for Vec<T> {
    fn put(&self, to: &mut Vec<u8>) {
        put_all(self, to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        T::take_each(usize::take(from)?, from)
    }
}

/// As a `Vec` of these values.
pub fn put_all<T: Wire>(values: &[T], to: &mut Vec<u8>) {
    values.len().put(to);
    to.reserve(size_of_val(values));
    T::put_each(values, to);
}

impl Wire for String {
    fn put(&self, to: &mut Vec<u8>) {
        self.len().put(to);
        to.extend_from_slice(self.as_bytes());
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        String::from_utf8(Vec::<u8>::take(from)?).map_err(|_| damaged())
    }
}

impl<T: Wire> Wire for Option<T> {
    fn put(&self, to: &mut Vec<u8>) {
        self.is_some().put(to);
        self.iter().for_each(|value| value.put(to));
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        bool::take(from)?.then(|| T::take(from)).transpose()
    }
}

/// Three numbers, as of a place.
macro_rules! wire_triples {
    ($($number:ty),+) => {$(
        impl Wire for [$number; 3] {
            fn put(&self, to: &mut Vec<u8>) {
                <$number>::put_each(self, to);
            }

            fn take(from: &mut &[u8]) -> Result<Self> {
                Ok([<$number>::take(from)?, <$number>::take(from)?, <$number>::take(from)?])
            }
        }
    )+};
}

wire_triples!(f64, u64);

impl<T: Wire> Wire for Box<T> {
    fn put(&self, to: &mut Vec<u8>) {
        T::put(self, to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        T::take(from).map(Self::new)
    }
}

impl<T: Wire> Wire for Box<[T]> {
    fn put(&self, to: &mut Vec<u8>) {
        put_all(self, to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        Vec::take(from).map(Into::into)
    }
}

impl<T: Wire> Wire for Arc<T> {
    fn put(&self, to: &mut Vec<u8>) {
        T::put(self, to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        T::take(from).map(Arc::new)
    }
}

impl<T: Wire> Wire for Arc<[T]> {
    fn put(&self, to: &mut Vec<u8>) {
        put_all(self, to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        Vec::take(from).map(Into::into)
    }
}

impl<A: Wire, B: Wire> Wire for (A, B) {
    fn put(&self, to: &mut Vec<u8>) {
        self.0.put(to);
        self.1.put(to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        Ok((A::take(from)?, B::take(from)?))
    }
}

impl<T: Wire> Wire for Result<T> {
    fn put(&self, to: &mut Vec<u8>) {
        self.is_ok().put(to);
        match self {
            Ok(value) => value.put(to),
            Err(error) => error.put(to),
        }
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        Ok(if bool::take(from)? { Ok(T::take(from)?) } else { Err(Error::take(from)?) })
    }
}

/// The kinds of errors of another rank; one of any other kind is an internal error there.
const KINDS: [Kind; 9] = [
    Kind::Internal,
    Kind::State,
    Kind::Memory,
    Kind::NullSpace,
    Kind::Indefinite,
    Kind::Overflow,
    Kind::Unsupported,
    Kind::Cancelled,
    Kind::TimeOver,
];

/// Without a proof: other ranks prove nothing.
impl Wire for Error {
    fn put(&self, to: &mut Vec<u8>) {
        let kind = KINDS.iter().position(|kind| *kind == self.kind).unwrap_or(0);
        (kind as u8).put(to);
        self.what.put(to);
        self.place.put(to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        let kind = KINDS.get(usize::from(u8::take(from)?)).copied().ok_or_else(damaged)?;
        Ok(Self { kind, what: String::take(from)?, place: Box::new(Place::take(from)?), proof: None })
    }
}

wire_struct!(Place {
    base,
    rank,
    body,
    component,
    element,
    pair,
    face,
    dof,
    node,
    row,
    kind,
    entry,
    byte,
    index,
    index_base,
    value,
    limit,
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_arrive_as_they_were_sent_bit_by_bit() {
        let all = (vec![1.5, -0.0, f64::MIN_POSITIVE / 4.0], (Some(String::from("size")), vec![true, false]));
        let sent: (Vec<f64>, (Option<String>, Vec<bool>)) = value(&message(&all)).unwrap();
        assert_eq!(sent, all);
        assert!(sent.0[1].is_sign_negative());
        let error = Error::new(Kind::NullSpace, "a mode is missing").body(3).dof(7).value(1e-9);
        let failed: Result<f64> = Err(error);
        assert_eq!(value::<Result<f64>>(&message(&failed)).unwrap(), failed);
    }

    #[test]
    fn damaged_messages_are_refused_before_memory_is_taken() {
        let whole = message(&(vec![1u64, 2, 3], Some(4.0)));
        for end in 0..whole.len() {
            assert!(value::<(Vec<u64>, Option<f64>)>(&whole[..end]).is_err(), "{end}");
        }
        assert!(value::<Vec<f64>>(&message(&u64::MAX)).is_err());
        assert!(value::<f64>(&message(&(1.0, 2u8))).is_err(), "longer than its value");
        assert!(value::<bool>(&[7]).is_err());
    }
}
