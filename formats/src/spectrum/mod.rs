//! CIE tables, named metals and indices, and the conversion of colours to linear Rec.709.
