//! What line specials move.
