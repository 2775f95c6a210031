//! Setters and an estimate shared by several methods.

/// Writes the setters of the named settings of a method, which stores them in its field `settings`.
macro_rules! setters {
    ($method:ty: $($setting:ident),+) => {
        impl $method {
            $(setters! { @ $setting })+
        }
    };
    (@ wave_speed) => {
        /// Sets a guess of the wave speed [m/s] at the first lines, accurate to 30 %. By default
        /// the speed is searched between 20 m/s and 20 km/s.
        ///
        /// # Errors
        /// [`CmodError::NonPhysical`] unless the speed is finite and above 0.
        pub fn with_wave_speed(mut self, wave_speed: f64) -> Result<Self, $crate::CmodError> {
            let speed = $crate::error::check_positive("wave speed [m/s]", wave_speed)?;
            self.settings.wave_speed = Some(speed);
            Ok(self)
        }
    };
    (@ delay) => {
        /// Sets the `delay` \[s\] of the later pulse relative to the earlier one, for example
        /// between the centres of their energy. Waves are then counted from line to line only in
        /// the phase beyond this delay, so the record need not be several delays long. The phase
        /// beyond the delay must advance by less than π per line; this is so if the record is
        /// longer than twice the difference of the group delays in the band. The delay does not
        /// change γ, because it is not subtracted from the ratio.
        ///
        /// # Errors
        /// [`CmodError::NonPhysical`] unless the delay is finite and above 0.
        pub fn with_delay(mut self, delay: f64) -> Result<Self, $crate::CmodError> {
            let delay = $crate::error::check_positive("delay of the later pulse [s]", delay)?;
            self.settings.delay = Some(delay);
            Ok(self)
        }
    };
    (@ uncertainty) => {
        /// Sets the standard uncertainties of the rod and its sections, which are the systematic
        /// part of the errors. For a method with one length of the rod, `distance` is the
        /// uncertainty of this length.
        ///
        /// # Errors
        /// [`CmodError::NonPhysical`] unless all uncertainties are finite and not negative.
        pub fn with_uncertainty(
            mut self,
            uncertainty: $crate::SectionUncertainty,
        ) -> Result<Self, $crate::CmodError> {
            self.settings.uncertainty = uncertainty.check()?;
            Ok(self)
        }
    };
    (@ noise_freedom) => {
        /// Sets the degrees of freedom of a measured noise, per gauge and line. The errors then
        /// have the degrees of freedom of the sum of the variances over the gauges, and a misfit is
        /// judged by Fisher's distribution with the degrees of freedom of one gauge.
        ///
        /// # Errors
        /// [`CmodError::NonPhysical`] unless the degrees of freedom are finite and above 0.
        pub fn with_noise_freedom(
            mut self,
            freedom: $crate::estimate::VarianceFreedom,
        ) -> Result<Self, $crate::CmodError> {
            self.settings.noise_freedom = Some(freedom.check()?);
            Ok(self)
        }
    };
    (@ limits) => {
        /// Sets the error limits that a valid line must meet. The limit of the coherence has no
        /// effect in this method.
        ///
        /// # Errors
        /// [`CmodError::NonPhysical`] for limits that are NaN or not above 0, or for a least
        /// coherence outside the range from 0 to 1.
        pub fn with_limits(
            mut self,
            limits: $crate::validity::AcceptanceLimits,
        ) -> Result<Self, $crate::CmodError> {
            self.settings.limits = limits.check()?;
            Ok(self)
        }
    };
}

/// Writes the method `estimate` of a [`RatioMethod`](crate::RatioMethod) from a ratio of known
/// variance, with its documentation and the name of the ratio.
macro_rules! estimate {
    ($(#[$doc:meta])+ $ratio:ident) => {
        $(#[$doc])+
        pub fn estimate(
            &self,
            frequency_hz: &[f64],
            $ratio: &[num_complex::Complex64],
            variance: &[f64],
        ) -> Result<$crate::ModulusEstimate, $crate::CmodError> {
            let lines = $crate::section_ratio::RatioLines::of_known_variance;
            $crate::RatioMethod::estimate_ratio(self, &lines(frequency_hz, $ratio, variance))
        }
    };
}
