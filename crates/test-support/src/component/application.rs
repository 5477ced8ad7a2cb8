//! Scenes with inputs over time in `tests/applications`.

use crate::{changed, reference};
use sliding_contact::component::{Component, Values};
use std::path::Path;
use std::sync::Arc;

/// A scene with its inputs.
#[derive(Clone, Debug)]
pub struct Application {
    /// Name of its files.
    pub name: String,
    /// Start values.
    pub starts: Values,
    /// Time (s), sliding velocity (m/s) and normal load (N); linear between.
    pub inputs: Vec<[f64; 3]>,
}

/// Result of a run.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Wear depth (m), rise of the contact temperature (K) and friction force (N) at the communication points.
    pub main: Vec<[f64; 3]>,
    /// `estimated_error` at the end.
    pub estimated_error: f64,
    /// Cells of the contact; 1 at the lumped level.
    pub cells: usize,
    /// Internal steps, accepted and rejected.
    pub steps: u64,
    /// It has warned that perturbations of the pressure grow.
    pub unstable: bool,
}

/// Communication steps of a run, besides those at the rows of the inputs.
const STEPS: f64 = 200.0;

impl Application {
    /// Reads `tests/applications/NAME.toml` and `.csv`.
    ///
    /// # Panics
    /// Where there is no such scene, or it does not read.
    pub fn read(name: &str) -> Application {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/applications"));
        let starts = scene_file::read(&folder.join(name).with_extension("toml")).unwrap().packaged.starts;
        let text = std::fs::read_to_string(folder.join(name).with_extension("csv")).unwrap();
        let (header, rows) = text.split_once('\n').unwrap();
        assert_eq!(header, "time [s],sliding_velocity [m/s],normal_load [N]");
        let row = |line: &str| {
            let mut numbers = line.split(',').map(|number| number.parse().unwrap());
            std::array::from_fn(|_| numbers.next().unwrap())
        };
        Application { name: name.to_owned(), starts, inputs: rows.lines().map(row).collect() }
    }

    /// Runs the scene with changes by name.
    pub fn run(&self, changes: &[(&str, f64)]) -> Result<Run, String> {
        let mut component = Component::new(Arc::new(changed(&self.starts, changes)));
        let inputs = ["sliding_velocity", "normal_load"].map(reference);
        inputs.into_iter().zip(&self.inputs[0][1..]).for_each(|(input, value)| component.set_input(input, *value));
        component.enter_initialization();
        component.initialise(Some(1e-3))?;
        let outputs = ["wear_depth", "contact_temperature", "friction_force"].map(reference);
        let ambient = self.starts[reference("ambient_temperature") as usize];
        let mut run = Run { main: vec![[0.0; 3]], ..Run::default() };
        let longest = (self.inputs[self.inputs.len() - 1][0] - self.inputs[0][0]) / STEPS;
        for rows in self.inputs.windows(2) {
            let length = rows[1][0] - rows[0][0];
            let parts = (length / longest).ceil().max(1.0);
            for part in 0..parts as u32 {
                for (input, column) in inputs.into_iter().zip(1..) {
                    let slope = (rows[1][column] - rows[0][column]) / length;
                    component.set_input(input, rows[0][column] + slope * length * f64::from(part) / parts);
                    component.set_input_derivative(input, slope);
                }
                component.step(length / parts).map_err(|text| format!("after {} s: {text}", rows[0][0]))?;
                let [wear, temperature, force] = outputs.map(|output| component.get(output));
                run.main.push([wear, temperature - ambient, force]);
            }
        }
        run.estimated_error = component.get(reference("estimated_error"));
        run.cells = component.operators().map_or(0, |operators| operators.cells());
        run.unstable = component.messages().any(|message| message.text.starts_with("thermoelastically unstable"));
        let (accepted, rejected) = component.work();
        run.steps = accepted + rejected;
        Ok(run)
    }
}

impl Run {
    /// Largest differences of the main outputs from those of `truth`, relative to its largest values.
    pub fn errors(&self, truth: &Run) -> [f64; 3] {
        std::array::from_fn(|output| {
            let size =
                |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |most: f64, value| most.max(value.abs()));
            let scale = size(&mut truth.main.iter().map(|main| main[output]));
            let apart = size(&mut self.main.iter().zip(&truth.main).map(|(own, other)| own[output] - other[output]));
            if apart == 0.0 { 0.0 } else { apart / scale }
        })
    }

    /// The largest of them.
    pub fn error(&self, truth: &Run) -> f64 {
        self.errors(truth).into_iter().fold(0.0, f64::max)
    }
}
