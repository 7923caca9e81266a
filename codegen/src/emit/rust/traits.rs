//! The traits that all drives share, for an emitted drive and its halves.

use super::imports::unsettled;
use super::interface::Types;
use super::names::{number, raw_text, snake, stored};
use super::source::{Source, quote};
use crate::interface::Rounding;

impl Types<'_> {
    /// The trait that all drives share.
    pub(super) fn drive_trait(&self) -> Source {
        let name = unsettled(self.name);
        let name_text = self.name;
        let spec = raw_text(&self.interface.spec_toml);
        let formats = self.interface.formats.iter().map(|entry| {
            let name = &entry.name;
            let storage_bits = number(i64::from(entry.storage_bits));
            let frac_bits = number(i64::from(entry.frac_bits));
            let rounding = match entry.rounding {
                Rounding::Floor => quote!(Rounding::Floor),
                Rounding::RoundHalfUp => quote!(Rounding::RoundHalfUp),
            };
            let segments = entry.segments.map(|segments| {
                let segments = number(i64::from(segments));
                quote!(.over(#segments))
            });
            quote!(Format::new(#name, #storage_bits, #frac_bits, #rounding)#segments)
        });
        let words = &self.program.states;
        let state_names = words.iter().map(|word| &word.name);
        let reads = words.iter().map(|word| {
            let field = snake(&word.name);
            if word.storage_bits == 16 {
                quote!(i32::from(self.state.#field))
            } else {
                quote!(self.state.#field.0)
            }
        });
        let writes = words.iter().enumerate().map(|(index, word)| {
            let field = snake(&word.name);
            let value = stored(word, &quote!(Word(value)));
            quote!(#index => self.state.#field = #value)
        });
        let measurements = self.measurements();
        let sample = measurements.iter().map(|(name, _, _)| quote!(sample.#name));
        let set_bus = if self.interface.bus_periods.is_some() {
            quote! {
                fn set_bus(&self, counts: u16) {
                    self.set_bus(counts);
                }
            }
        } else {
            quote!(
                fn set_bus(&self, _counts: u16) {}
            )
        };
        let has_speed = self
            .program
            .setters
            .iter()
            .any(|setter| setter.name == "set_speed");
        let set_speed = has_speed.then(|| {
            quote! {
                fn set_speed(&self, speed: I16F16) {
                    self.set_speed(speed);
                }
            }
        });
        quote! {
            impl Drive for #name {
                type SetPointHalf = SetPoint;
                type LoopHalf<'drive> = ControlLoop<'drive>;

                const NAME: &'static str = #name_text;
                const SPEC: &'static str = #spec;
                const FORMATS: &'static [Format] = &[#(#formats),*];
                const STATE_NAMES: &'static [&'static str] = &[#(#state_names),*];

                fn new() -> Self {
                    Self::new()
                }

                fn split(&mut self) -> (&SetPoint, ControlLoop<'_>) {
                    self.split()
                }

                fn set_point(&self) -> &SetPoint {
                    &self.set_point
                }

                #[inline]
                fn state_words(&self, words: &mut [i32]) {
                    if let Some(words) = words.first_chunk_mut() {
                        *words = [#(#reads),*];
                    }
                }

                fn set_state_word(&mut self, index: usize, value: i32) {
                    match index {
                        #(#writes,)*
                        _ => {}
                    }
                    self.split().1.publish();
                }
            }

            impl DriveSetPoint for SetPoint {
                fn set_current(&self, current: I16F16) {
                    self.set_current(current);
                }

                fn set_torque(&self, torque: I16F16) {
                    self.set_torque(torque);
                }

                #set_speed

                #set_bus

                fn status(&self) -> Status {
                    self.status()
                }
            }

            impl DriveLoop for ControlLoop<'_> {
                #[inline]
                fn step(&mut self, sample: &Sample) -> Legs {
                    self.step(#(#sample),*)
                }

                fn reset(&mut self) {
                    self.reset();
                }

                fn calibrate(&mut self) {
                    self.calibrate();
                }

                fn precharge(&mut self) {
                    self.precharge();
                }

                fn status(&self) -> Status {
                    self.status()
                }
            }
        }
    }
}
