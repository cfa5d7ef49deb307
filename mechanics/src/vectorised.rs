//! The widest vector units of the processor, chosen when the program runs.

/// Runs a loop compiled for the widest vector units that this processor has. The compiler neither
/// reorders nor fuses sums, so that iterations give the same bits on every processor.
///
/// `body` must be a closure marked `#[inline(always)]`, or it is compiled for the oldest processors.
#[inline]
pub fn vectorised(body: impl FnMut()) {
    pulp::Arch::new().dispatch(Body(body));
}

struct Body<F>(F);

impl<F: FnMut()> pulp::WithSimd for Body<F> {
    type Output = ();

    // Called by reference: a call by value would go through a shim that is never inlined.
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(mut self, _simd: S) {
        (self.0)();
    }
}
