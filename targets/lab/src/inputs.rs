//! Inputs of a step from the supervisor's checked sample.

use hexagen::Checked;
use hexagen_codegen::ir::Program;

/// The inputs of a program's step, in its order.
#[derive(Clone, Debug)]
pub struct Inputs(Vec<Input>);

#[derive(Clone, Copy, Debug)]
enum Input {
    CurrentA,
    CurrentB,
    Hall,
    HallTicks,
    Angle,
}

impl Inputs {
    /// Those of a drive's program; `None` if it has others.
    pub fn of(program: &Program) -> Option<Self> {
        let inputs = program.step.inputs.iter();
        let inputs = inputs.map(|input| {
            Some(match input.name.as_str() {
                "i_a" => Input::CurrentA,
                "i_b" => Input::CurrentB,
                "hall" => Input::Hall,
                "hall_ticks" => Input::HallTicks,
                "angle" => Input::Angle,
                _ => return None,
            })
        });
        inputs.collect::<Option<_>>().map(Self)
    }

    /// The input words of a period.
    pub fn words(&self, checked: &Checked) -> Vec<i32> {
        let word = |input: &Input| match input {
            Input::CurrentA => checked.i_a().0,
            Input::CurrentB => checked.i_b().0,
            Input::Hall => checked.hall().0,
            Input::HallTicks => checked.hall_ticks().0,
            Input::Angle => checked.angle().0,
        };
        self.0.iter().map(word).collect()
    }
}
