//! Slots: what becomes of a job whose work panics, is dismissed or loses its storage.

mod slots;
