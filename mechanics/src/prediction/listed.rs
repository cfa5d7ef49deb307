//! Enumerations with a list of their members.

/// Writes an enum together with the list of its members, so that none can be missing from the list.
macro_rules! listed {
    ($(#[$of_all:meta])* pub enum $name:ident { $($(#[$of_one:meta])* $member:ident,)* }) => {
        $(#[$of_all])*
        pub enum $name { $($(#[$of_one])* $member,)* }

        impl $name {
            /// All of them.
            pub const ALL: &[$name] = &[$($name::$member,)*];
        }
    };
}

pub(super) use listed;
