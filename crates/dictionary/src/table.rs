//! [`object_dictionary!`](crate::object_dictionary).

/// Declares an object dictionary: a struct of typed fields and its table of entries, from one row an entry.
///
/// A row reads `index:sub field: type = default, access (, in range)? (, unit "...")?, "Name" (of "Object")?;` under a doc comment that
/// says what the object means and where the manual says so. Access flags are those of [`Access`](crate::Access). Objects with
/// sub-indices name the object after `of`; their sub-index 0 is derived. A row without a range takes the whole range of its type.
///
/// The macro makes `new`, `ENTRIES`, an implementation of [`Objects`](crate::Objects) that checks lengths and ranges, and a module of
/// slots, one constant a field. Order, uniqueness and defaults are checked at compile time.
///
/// ```
/// dictionary::object_dictionary! {
///     /// The objects of a lamp.
///     pub struct LampObjects in lamp_slots {
///         /// Brightness of the lamp.
///         0x2000:0 brightness: u16 = 50, RW | RX_PDO | SAVED, in 0..=100, unit "%", "Brightness";
///         /// Red part of the colour.
///         0x2001:1 red: u8 = 255, RW, "Red" of "Colour";
///         /// Green part of the colour.
///         0x2001:2 green: u8 = 255, RW, "Green" of "Colour";
///     }
/// }
/// use dictionary::{AbortCode, Objects};
/// let mut lamp = LampObjects::new();
/// assert_eq!(lamp.store(lamp_slots::brightness, &[101, 0]), Err(AbortCode::ValueTooHigh));
/// assert_eq!(lamp.store(lamp_slots::brightness, &[100, 0]), Ok(()));
/// assert_eq!(lamp.brightness, 100);
/// ```
#[macro_export]
macro_rules! object_dictionary {
    (
        $(#[$meta:meta])*
        $vis:vis struct $name:ident in $slots:ident {
            $(
                $(#[doc = $doc:literal])+
                $index:literal : $sub:literal $field:ident : $type:ty = $default:expr, $($flag:ident)|+
                $(, in $range:expr)? $(, unit $unit:literal)?, $title:literal $(of $object:literal)?;
            )+
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        $vis struct $name {
            $($(#[doc = $doc])+ pub $field: $type,)+
        }

        #[doc = concat!("Slots of [`", stringify!($name), "`], one constant a field.")]
        #[allow(non_upper_case_globals)]
        $vis mod $slots {
            #[allow(non_camel_case_types, clippy::enum_variant_names)]
            enum Position { $($field),+ }
            $(
                #[doc = concat!("Slot of `", stringify!($field), "`.")]
                pub const $field: usize = Position::$field as usize;
            )+
        }

        impl $name {
            /// All entries, sorted by index and sub-index.
            pub const ENTRIES: &'static [$crate::Entry] = &[$(
                $crate::Entry {
                    index: $index,
                    sub: $sub,
                    name: $title,
                    object: $crate::object_dictionary!(@object $title $(, $object)?),
                    data_type: <$type as $crate::Value>::DATA_TYPE,
                    bits: match <$type as $crate::Value>::DATA_TYPE.bits() {
                        Some(bits) => bits as u16,
                        None => panic!("entries of a table have a fixed length"),
                    },
                    access: $crate::object_dictionary!(@access $($flag)+),
                    default: $default as i64,
                    min: $crate::object_dictionary!(@min $type $(, $range)?),
                    max: $crate::object_dictionary!(@max $type $(, $range)?),
                    unit: concat!($($unit)?),
                    doc: concat!($($doc, "\n"),+),
                },
            )+];

            /// All objects at their defaults.
            pub const fn new() -> Self {
                Self { $($field: $default,)+ }
            }
        }

        impl Default for $name {
            fn default() -> Self {
                Self::new()
            }
        }

        impl $crate::Objects for $name {
            fn entries(&self) -> &'static [$crate::Entry] {
                Self::ENTRIES
            }

            fn load(&self, slot: usize, out: &mut [u8; $crate::MAX_VALUE_SIZE]) -> usize {
                match slot {
                    $($slots::$field => $crate::Value::put(self.$field, out),)+
                    _ => 0,
                }
            }

            fn store(&mut self, slot: usize, data: &[u8]) -> Result<(), $crate::AbortCode> {
                match slot {
                    $($slots::$field => self.$field = $crate::value::parse(&Self::ENTRIES[slot], data)?,)+
                    _ => return Err($crate::AbortCode::ObjectNotFound),
                }
                Ok(())
            }
        }

        const _: () = $crate::check::assert_table($name::ENTRIES);
    };

    (@object $title:literal) => { $title };
    (@object $title:literal, $object:literal) => { $object };
    (@access $first:ident $($flag:ident)*) => { $crate::Access::$first$(.with($crate::Access::$flag))* };
    (@min $type:ty) => { <$type as $crate::Value>::MIN };
    (@min $type:ty, $range:expr) => {{
        const RANGE: core::ops::RangeInclusive<i64> = $range;
        *RANGE.start()
    }};
    (@max $type:ty) => { <$type as $crate::Value>::MAX };
    (@max $type:ty, $range:expr) => {{
        const RANGE: core::ops::RangeInclusive<i64> = $range;
        *RANGE.end()
    }};
}
