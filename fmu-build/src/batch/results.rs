//! Results of a batch: appended row by row as they come, written in order and complete at the end.

use super::worker::{Answer, OK};
use crate::project;
use anyhow::{Context, Result, bail};
use scene::fnv::Fnv;
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

/// One row, its cells after the number of the scene.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Row {
    scene: usize,
    cells: Vec<String>,
}

impl Row {
    /// From a scene's cells of the design and its answer; results that are not there are empty cells.
    pub fn of(scene: usize, design: &[String], answer: &Answer, width: usize) -> Self {
        let mut cells = design.to_vec();
        cells.extend(answer.values.iter().cloned());
        cells.resize(design.len() + width, String::new());
        cells.push(answer.status.clone());
        // One row is one line, so that a torn one is known by its missing end.
        cells.push(answer.reason.replace(['\n', '\r'], " "));
        Self { scene, cells }
    }

    fn text(&self) -> Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_field(self.scene.to_string())?;
        writer.write_record(&self.cells)?;
        Ok(writer.into_inner()?)
    }
}

/// Rows that failed, and why.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Failures {
    /// Number of rows.
    pub count: usize,
    /// Reasons with their numbers of rows, the most frequent first.
    pub reasons: Vec<(String, usize)>,
}

/// Rows that are there, and the file beside the output that holds them until all are.
///
/// A finished output has a file `.batch` beside it with the fingerprint of the batch, so that a longer design continues it.
pub struct Results {
    output: PathBuf,
    partial: PathBuf,
    batch: PathBuf,
    fingerprint: String,
    header: Vec<String>,
    file: File,
    rows: BTreeMap<usize, Vec<String>>,
}

impl Results {
    /// Continues what an earlier run left beside or in `output`, or begins. Rows are those of the design where their cells are the same.
    ///
    /// # Errors
    /// Where what is there belongs to another batch, or a file cannot be read or written.
    pub fn open(output: &Path, header: &[String], fingerprint: &str, design: &[Vec<String>]) -> Result<Self> {
        let output = &project::replaceable(output)?;
        let beside = |ending: &str| {
            let mut name = output.as_os_str().to_owned();
            name.push(ending);
            PathBuf::from(name)
        };
        let (partial, batch) = (beside(".partial"), beside(".batch"));
        let is_own = |scene: usize, cells: &[String]| design.get(scene).is_some_and(|own| cells.starts_with(own));
        let context = || format!("opening {}", partial.display());
        let first = format!("# {fingerprint}\n");
        let mut rows = BTreeMap::new();
        let mut whole = 0;
        if partial.exists() {
            let text = fs::read(&partial).with_context(context)?;
            // A run that was killed may have left half a line.
            whole = text.iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1);
            if whole > 0 {
                let Some(rest) = text[..whole].strip_prefix(first.as_bytes()) else {
                    bail!(
                        "{} belongs to another FMU, design, schedule or settings; remove it, or name another --output",
                        partial.display()
                    );
                };
                for record in csv::ReaderBuilder::new().has_headers(false).from_reader(rest).records() {
                    let (scene, cells) = cells(&record.with_context(context)?).with_context(context)?;
                    if scene < design.len() && !is_own(scene, &cells) {
                        bail!(
                            "{} belongs to another design: its scene {scene} differs; remove it, or name another --output",
                            partial.display()
                        );
                    }
                    rows.insert(scene, cells);
                }
                rows.retain(|&scene, _| scene < design.len());
            }
        } else if fs::read_to_string(&batch).is_ok_and(|found| found.trim_end() == fingerprint) && output.is_file() {
            let mut reader = csv::Reader::from_path(output).with_context(context)?;
            if reader.headers().with_context(context)?.iter().eq(header) {
                for record in reader.records() {
                    let (scene, cells) = cells(&record.with_context(context)?).with_context(context)?;
                    if is_own(scene, &cells) {
                        rows.insert(scene, cells);
                    }
                }
            }
        } else if let Some(folder) = output.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            fs::create_dir_all(folder).with_context(context)?;
        }
        let mut file = OpenOptions::new().create(true).append(true).open(&partial).with_context(context)?;
        file.set_len(whole as u64).with_context(context)?;
        if whole == 0 {
            file.write_all(first.as_bytes()).with_context(context)?;
            for (&scene, cells) in &rows {
                file.write_all(&Row { scene, cells: cells.clone() }.text()?).with_context(context)?;
            }
        }
        // A batch that is under way is known by its partial file alone.
        let _ = fs::remove_file(&batch);
        let fingerprint = fingerprint.to_owned();
        Ok(Self { output: output.to_owned(), partial, batch, fingerprint, header: header.to_vec(), file, rows })
    }

    /// Whether the scene's row is there.
    pub fn has(&self, scene: usize) -> bool {
        self.rows.contains_key(&scene)
    }

    /// Appends a row to the file immediately.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn add(&mut self, row: &Row) -> Result<()> {
        self.file.write_all(&row.text()?).with_context(|| format!("writing {}", self.partial.display()))?;
        self.rows.insert(row.scene, row.cells.clone());
        Ok(())
    }

    /// Writes the output with all rows in order, removes what was kept on the way, and returns what failed.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn finish(self) -> Result<Failures> {
        let context = || format!("writing {}", self.output.display());
        let mut name = self.output.as_os_str().to_owned();
        name.push(format!(".{}", std::process::id()));
        let whole = PathBuf::from(name);
        let mut writer = csv::Writer::from_path(&whole).with_context(context)?;
        writer.write_record(&self.header)?;
        for (scene, cells) in &self.rows {
            writer.write_field(scene.to_string())?;
            writer.write_record(cells)?;
        }
        writer.into_inner()?.sync_all().with_context(context)?;
        fs::rename(&whole, &self.output).with_context(context)?;
        fs::write(&self.batch, format!("{}\n", self.fingerprint)).with_context(context)?;
        fs::remove_file(&self.partial).with_context(context)?;
        let status = self.header.len() - 3;
        let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
        for cells in self.rows.values().filter(|cells| cells[status] != OK) {
            *reasons.entry(&cells[status + 1]).or_default() += 1;
        }
        let mut reasons: Vec<(String, usize)> =
            reasons.into_iter().map(|(reason, count)| (reason.to_owned(), count)).collect();
        reasons.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        Ok(Failures { count: reasons.iter().map(|(_, count)| count).sum(), reasons })
    }
}

/// Scene and cells of a row.
fn cells(record: &csv::StringRecord) -> Result<(usize, Vec<String>)> {
    Ok((record[0].parse()?, record.iter().skip(1).map(str::to_owned).collect()))
}

/// Fingerprint of a batch, so that rows of different batches are not mixed: FNV-1a over everything, each part with its length.
pub fn fingerprint(parts: &[&[u8]]) -> String {
    let mut hash = Fnv::new();
    for part in parts {
        for &byte in (part.len() as u64).to_le_bytes().iter().chain(*part) {
            hash = hash.with(byte);
        }
    }
    format!("{:016x}", hash.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(scene: usize, reason: &str) -> Row {
        let status = if reason.is_empty() { OK } else { "stepping" };
        let values = if reason.is_empty() { vec!["1.5".to_owned()] } else { Vec::new() };
        let answer = Answer { status: status.into(), reason: reason.into(), values };
        Row::of(scene, &["0.1".to_owned()], &answer, 1)
    }

    #[test]
    fn what_is_there_stays_and_a_torn_line_goes() {
        let folder = std::env::temp_dir().join(format!("batch-results-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        let output = folder.join("out.csv");
        let header = ["scene", "punch.width", "wear_depth", "status", "reason"].map(str::to_owned);
        let design = vec![vec!["0.1".to_owned()]; 3];
        let mut results = Results::open(&output, &header, "a", &design).unwrap();
        results.add(&row(2, "")).unwrap();
        results.add(&row(0, "too hot, \"by far\"\nsee above")).unwrap();
        drop(results);
        let partial = folder.join("out.csv.partial");
        let whole = fs::read(&partial).unwrap();
        fs::write(&partial, [whole.as_slice(), b"1,0.1,1."].concat()).unwrap();

        assert!(
            Results::open(&output, &header, "b", &design).is_err_and(|error| error.to_string().contains("another"))
        );
        let other = vec![vec!["0.2".to_owned()]; 3];
        assert!(
            Results::open(&output, &header, "a", &other)
                .is_err_and(|error| error.to_string().contains("scene 2 differs"))
        );
        let mut results = Results::open(&output, &header, "a", &design).unwrap();
        assert_eq!([0, 1, 2].map(|scene| results.has(scene)), [true, false, true]);
        assert_eq!(fs::read(&partial).unwrap(), whole);
        results.add(&row(1, "")).unwrap();
        let failures = results.finish().unwrap();
        assert_eq!(failures, Failures { count: 1, reasons: vec![("too hot, \"by far\" see above".to_owned(), 1)] });
        assert_eq!(
            fs::read_to_string(&output).unwrap(),
            "scene,punch.width,wear_depth,status,reason\n\
             0,0.1,,stepping,\"too hot, \"\"by far\"\" see above\"\n1,0.1,1.5,ok,\n2,0.1,1.5,ok,\n"
        );
        assert!(!partial.exists());

        // A longer design continues it; a row of another is computed again, as are all after a change of anything else.
        let mut longer = vec![vec!["0.1".to_owned()]; 5];
        longer[1][0] = "0.7".to_owned();
        let known = |fingerprint: &str| {
            let results = Results::open(&output, &header, fingerprint, &longer).unwrap();
            let known: Vec<usize> = (0..5).filter(|scene| results.has(*scene)).collect();
            fs::remove_file(&partial).unwrap();
            known
        };
        assert!(known("b").is_empty());
        fs::write(folder.join("out.csv.batch"), "a\n").unwrap();
        assert_eq!(known("a"), [0, 2]);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn fingerprints_tell_parts_apart() {
        assert_ne!(fingerprint(&[b"ab", b"c"]), fingerprint(&[b"a", b"bc"]));
        assert_eq!(fingerprint(&[b"ab"]), fingerprint(&[b"ab"]));
    }
}
