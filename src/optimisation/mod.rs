//! Inverse planning: the movements of segments that bring the skin closest to where it is wanted.
