//! Options that carry what they are.

/// Keeps the doc comments of options beside their names, so that `pipeline config` prints what stands here. rustfmt does not format what
/// stands in it.
macro_rules! documented {
    ($(#[$meta:meta])* pub struct $name:ident { $($(#[doc = $doc:literal])+ pub $key:ident: $type:ty,)* }) => {
        $(#[$meta])*
        pub struct $name { $($(#[doc = $doc])+ pub $key: $type,)* }
        impl $name {
            /// Every option with the lines of its doc comment.
            pub(crate) const COMMENTS: Comments = &[$((stringify!($key), &[$($doc),+])),*];
        }
    };
}

/// Options with the lines of their doc comments.
pub(crate) type Comments = &'static [(&'static str, &'static [&'static str])];

/// The comment on one option.
pub(crate) fn find(comments: Comments, key: &str) -> &'static [&'static str] {
    let found = comments.iter().find(|(name, _)| *name == key);
    found.map_or(&[], |(_, lines)| lines)
}
