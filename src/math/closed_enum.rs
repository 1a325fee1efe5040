//! How the renderer chooses among models: one macro makes every closed set of them.

/// Makes a trait, the closed enum of everything that implements it, and the enum's methods, which hand each call to
/// the model inside. One `match` and no virtual call, and every model is named in one place: its row in the enum.
///
/// Two forms:
///
/// ```text
/// closed_enum! {
///     /// The contract.
///     pub trait Light {
///         /// Documented here, for all models and for the enum.
///         fn power(&self, textures: &Textures) -> Color;
///         /// A body is the answer of models that give none.
///         fn is_infinite(&self) -> bool { false }
///     }
///     #[derive(Clone, Debug)]
///     pub enum Emitter { Point(Point), Environment(Box<Environment>) }
/// }
/// ```
///
/// for variants that hold a model (`From` is implemented for each), and
///
/// ```text
/// closed_enum! {
///     pub trait Kernel: Copy { fn shape(u2: f32) -> f32; }
///     pub enum KernelKind { Cone, Epanechnikov } chosen by with_kernel in kernel
/// }
/// ```
///
/// for types without a value: the methods of the trait take no `self`, those of the enum do, `ALL` lists the variants,
/// and `with_kernel!(kind, K => body)` compiles `body` once for each type `K`. The module (`kernel`) stands in `math`.
macro_rules! closed_enum {
    (
        $(#[$trait_meta:meta])*
        $trait_vis:vis trait $Trait:ident {
            $(
                $(#[doc = $doc:literal])*
                $(#[inline $how:tt])?
                fn $f:ident(&$this:ident $(, $arg:ident: $t:ty)* $(,)?) $(-> $ret:ty)?
                $({ $($body:tt)* })? $(;)?
            )+
        }
        $(#[$enum_meta:meta])*
        $vis:vis enum $Enum:ident $variants:tt
    ) => {
        $(#[$trait_meta])*
        $trait_vis trait $Trait {
            $($crate::math::closed_enum! {
                @declare $(#[doc = $doc])* fn $f(&$this $(, $arg: $t)*) $(-> $ret)? $({ $($body)* })?
            })+
        }
        $(#[$enum_meta])*
        // A variant is documented by the model that it holds.
        #[allow(missing_docs)]
        $vis enum $Enum $variants
        impl $Enum {
            $($crate::math::closed_enum! {
                @dispatch [$vis] $variants ($($arg),*) $(#[doc = $doc])* $(#[inline $how])?
                fn $f(&$this $(, $arg: $t)*) $(-> $ret)?
            })+
        }
        $crate::math::closed_enum! { @from $Enum $variants }
    };

    (@declare $(#[$meta:meta])* fn $f:ident($($args:tt)*) $(-> $ret:ty)?) => {
        $(#[$meta])*
        fn $f($($args)*) $(-> $ret)?;
    };
    (@declare $(#[$meta:meta])* fn $f:ident($($args:tt)*) $(-> $ret:ty)? $body:block) => {
        $(#[$meta])*
        fn $f($($args)*) $(-> $ret)? $body
    };
    (
        @dispatch [$vis:vis] { $($(#[$meta:meta])* $Variant:ident($Model:ty)),+ $(,)? } $args:tt
        $(#[$method_meta:meta])*
        fn $f:ident(&$this:ident $(, $arg:ident: $t:ty)*) $(-> $ret:ty)?
    ) => {
        $(#[$method_meta])*
        $vis fn $f(&$this $(, $arg: $t)*) $(-> $ret)? {
            match $this { $(Self::$Variant(model) => model.$f $args),+ }
        }
    };
    (@from $Enum:ident { $($(#[$meta:meta])* $Variant:ident($Model:ty)),+ $(,)? }) => {
        $(impl From<$Model> for $Enum {
            fn from(model: $Model) -> Self {
                Self::$Variant(model)
            }
        })+
    };

    (
        $(#[$trait_meta:meta])*
        $trait_vis:vis trait $Trait:ident: $Bound:ident {
            $(
                $(#[doc = $doc:literal])*
                fn $f:ident($($arg:ident: $t:ty),* $(,)?) $(-> $ret:ty)?;
            )+
        }
        $(#[$enum_meta:meta])*
        $vis:vis enum $Enum:ident $variants:tt chosen by $with:ident in $module:ident
    ) => {
        $(#[$trait_meta])*
        $trait_vis trait $Trait: $Bound {
            $(
                $(#[doc = $doc])*
                fn $f($($arg: $t),*) $(-> $ret)?;
            )+
        }
        $crate::math::closed_enum! {
            @choice $(#[$enum_meta])* $vis enum $Enum $variants chosen by $with in $module
        }
        impl $Enum {
            $($crate::math::closed_enum! {
                @choose [$vis] $Trait $variants ($($arg),*) $(#[doc = $doc])* fn $f($($arg: $t),*) $(-> $ret)?
            })+
        }
    };
    (
        @choice $(#[$meta:meta])*
        $vis:vis enum $Enum:ident { $($Variant:ident),+ $(,)? } chosen by $with:ident in $module:ident
    ) => {
        $(#[$meta])*
        $vis enum $Enum {
            $(#[doc = concat!("The type [`", stringify!($Variant), "`](struct@", stringify!($Variant), ").")] $Variant),+
        }
        impl $Enum {
            /// Every one, in the order of the table.
            pub const ALL: &'static [Self] = &[$(Self::$Variant),+];
        }
        macro_rules! $with {
            ($choice:expr, $T:ident => $chosen:expr) => {
                match $choice { $($crate::math::$module::$Enum::$Variant => {
                    type $T = $crate::math::$module::$Variant;
                    $chosen
                }),+ }
            };
        }
    };
    (
        @choose [$vis:vis] $Trait:ident { $($Variant:ident),+ $(,)? } $args:tt
        $(#[$method_meta:meta])*
        fn $f:ident($($arg:ident: $t:ty),*) $(-> $ret:ty)?
    ) => {
        $(#[$method_meta])*
        $vis fn $f(self $(, $arg: $t)*) $(-> $ret)? {
            match self { $(Self::$Variant => <$Variant as $Trait>::$f $args),+ }
        }
    };
}
pub(crate) use closed_enum;
