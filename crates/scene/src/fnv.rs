//! The 64-bit hash FNV-1a (Fowler, Noll, Vo). Each step is a bijection of the running value, so a change of any one byte is seen;
//! it does not resist someone who constructs a collision.

/// Running value of the hash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fnv(pub u64);

impl Default for Fnv {
    fn default() -> Self {
        Self::new()
    }
}

impl Fnv {
    /// Of no bytes.
    pub const fn new() -> Fnv {
        Fnv(0xcbf2_9ce4_8422_2325)
    }

    /// With one byte more.
    #[must_use]
    pub const fn with(self, byte: u8) -> Fnv {
        Fnv((self.0 ^ byte as u64).wrapping_mul(0x0000_0100_0000_01b3))
    }

    /// Of these bytes.
    pub fn of(bytes: impl IntoIterator<Item = u8>) -> Fnv {
        bytes.into_iter().fold(Fnv::new(), Fnv::with)
    }
}

#[cfg(test)]
mod tests {
    use super::Fnv;

    /// Test vectors of the authors of the hash.
    #[test]
    fn published_values_are_met() {
        for (text, expected) in
            [("", 0xcbf2_9ce4_8422_2325), ("a", 0xaf63_dc4c_8601_ec8c), ("foobar", 0x8594_4171_f739_67e8)]
        {
            assert_eq!(Fnv::of(text.bytes()), Fnv(expected), "{text}");
        }
    }
}
