//! Results of a batch: appended row by row as they come, written in order and complete at the end.

use super::worker::{Answer, OK};
use crate::project;
use anyhow::{Context, Result, anyhow, bail};
use scene::fnv::Fnv;
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// One row, its cells after the number of the scene.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Row {
    scene: usize,
    cells: Vec<String>,
}

impl Row {
    /// From a scene's cells of the design and its answer; results that are not there are empty cells.
    pub(crate) fn of(scene: usize, design: &[String], answer: &Answer, width: usize) -> Self {
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

#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Failures {
    /// Number of rows.
    pub count: usize,
    /// The most frequent first.
    pub reasons: Vec<Reason>,
}

#[derive(serde::Serialize, Clone, PartialEq, Eq, Debug)]
pub(crate) struct Reason {
    /// As the FMU says it.
    pub reason: String,
    /// Number of scenes that failed for it.
    pub scenes: usize,
    /// The first of them.
    pub first: usize,
}

/// Identity of a batch, so that rows of different ones are not mixed: hashes of what they depend on, by name, in one line of text.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Identity(String);

impl Identity {
    pub(crate) fn of(parts: &[(&str, &[u8])]) -> Self {
        let hashed: Vec<String> = parts.iter().map(|(name, part)| format!("{name} {}", fingerprint(part))).collect();
        Self(hashed.join(", "))
    }

    /// Names of the parts that differ from those of a text of an identity; all where it is none.
    fn differences(&self, found: &str) -> String {
        let found: Vec<&str> = found.split(", ").collect();
        let parts = self.0.split(", ").filter(|part| !found.contains(part));
        parts.filter_map(|part| part.split(' ').next()).collect::<Vec<_>>().join(", ")
    }
}

/// Rows that are there, and the file beside the output that holds them until all are.
///
/// A finished output has a file `.batch` beside it with the identity of the batch, so that a longer design continues it.
pub(crate) struct Results {
    output: PathBuf,
    partial: PathBuf,
    batch: PathBuf,
    identity: Identity,
    header: Vec<String>,
    file: File,
    rows: BTreeMap<usize, Vec<String>>,
}

/// The partial file of a batch, locked while it is looked at.
struct Held<'a> {
    path: &'a Path,
    file: File,
    /// Whether an earlier run has left it; one that was made here goes again where there is no batch.
    is_older: bool,
}

impl<'a> Held<'a> {
    fn new(path: &'a Path, output: &Path) -> Result<Self> {
        let context = || format!("opening {}", path.display());
        let file = OpenOptions::new().read(true).append(true).create(true).open(path).with_context(context)?;
        lock(&file, path, output)?;
        let is_older = file.metadata().with_context(context)?.len() > 0;
        Ok(Self { path, file, is_older })
    }
}

impl Drop for Held<'_> {
    fn drop(&mut self) {
        if !self.is_older {
            let _ = fs::remove_file(self.path);
        }
    }
}

/// Refuses a file that another batch that runs holds.
fn lock(partial: &File, path: &Path, output: &Path) -> Result<()> {
    match partial.try_lock() {
        Err(TryLockError::WouldBlock) => bail!(
            "--output {}: another `cargo fmu batch` that still runs writes its rows to {}; wait until it has ended, or name another --output",
            output.display(),
            path.display()
        ),
        // Not every file system has locks.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(()),
    }
}

impl Results {
    /// Continues what an earlier run left beside or in `output`, or begins. Rows are those of the design where their cells are the same.
    /// `replace`: what belongs to another batch or to other cells is replaced.
    pub(crate) fn open(
        output: &Path,
        header: &[String],
        identity: &Identity,
        design: &[Vec<String>],
        replace: bool,
    ) -> Result<Self> {
        let output = &project::replaceable(output)?;
        let beside = |ending: &str| {
            let mut name = output.as_os_str().to_owned();
            name.push(ending);
            PathBuf::from(name)
        };
        let (partial, batch) = (beside(".partial"), beside(".batch"));
        let context = || format!("opening {}", partial.display());
        let other = |path: &Path, is: &str| anyhow!("{} {is}; name another --output, or say --replace", path.display());
        if let Some(folder) = output.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            fs::create_dir_all(folder).with_context(context)?;
        }
        let mut held = Held::new(&partial, output)?;
        let (source, found, records) = if held.is_older {
            let mut text = Vec::new();
            held.file.read_to_end(&mut text).with_context(context)?;
            // A run that was killed may have left half a line.
            text.truncate(text.iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1));
            let first = text.iter().position(|&byte| byte == b'\n').map_or(0, |at| at + 1);
            let found = String::from_utf8_lossy(&text[..first]).trim_start_matches("# ").trim_end().to_owned();
            (&partial, Some(found).filter(|_| first > 0), text.split_off(first))
        } else if output.is_file() {
            let Some(found) = fs::read_to_string(&batch).ok().or_else(|| replace.then(String::new)) else {
                return Err(other(output, "is there and no result of a batch"));
            };
            let text = fs::read(output).with_context(context)?;
            let first = text.iter().position(|&byte| byte == b'\n').map_or(0, |at| at + 1);
            (output, Some(found.trim_end().to_owned()), text[first..].to_vec())
        } else {
            (&partial, None, Vec::new())
        };
        let is_same = found.as_ref().is_none_or(|found| *found == identity.0);
        if let Some(found) = found.filter(|_| !is_same && !replace) {
            return Err(other(source, &format!("belongs to another batch: {} differ", identity.differences(&found))));
        }
        let (mut rows, mut lost) = (BTreeMap::new(), Vec::new());
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(records.as_slice());
        for record in reader.records().take_while(|_| is_same) {
            let (scene, cells) = cells(&record.with_context(context)?).with_context(context)?;
            if design.get(scene).is_some_and(|own| cells.starts_with(own)) {
                rows.insert(scene, cells);
            } else if status(&cells) == Some(OK) {
                // Of a scene that failed there is no result that could be lost.
                lost.push(scene);
            }
        }
        if let Some(first) = lost.first().filter(|_| !replace) {
            let is = format!(
                "has results of scenes that the design does not have, or has with other cells ({} of them, the first of scene {first})",
                lost.len()
            );
            return Err(other(source, &is));
        }
        // Written whole and put in its place, so that a run that is killed here loses none.
        let whole = beside(&format!(".partial.{}", std::process::id()));
        let mut text = format!("# {}\n", identity.0).into_bytes();
        for (&scene, cells) in &rows {
            text.extend(Row { scene, cells: cells.clone() }.text()?);
        }
        let mut file = File::create(&whole).with_context(context)?;
        file.write_all(&text).with_context(context)?;
        lock(&file, &partial, output)?;
        held.is_older = true;
        drop(held);
        fs::rename(&whole, &partial).with_context(context)?;
        // A batch that is under way is known by its partial file alone.
        let _ = fs::remove_file(&batch);
        let identity = identity.clone();
        Ok(Self { output: output.to_owned(), partial, batch, identity, header: header.to_vec(), file, rows })
    }

    /// Cells of the rows that are there, without the number of the scene.
    pub(crate) fn rows(&self) -> impl Iterator<Item = &Vec<String>> + Clone {
        self.rows.values()
    }

    /// Whether the scene's row is there.
    pub(crate) fn has(&self, scene: usize) -> bool {
        self.rows.contains_key(&scene)
    }

    /// Appends a row to the file immediately.
    pub(crate) fn add(&mut self, row: &Row) -> Result<()> {
        self.file.write_all(&row.text()?).with_context(|| format!("writing {}", self.partial.display()))?;
        self.rows.insert(row.scene, row.cells.clone());
        Ok(())
    }

    /// Writes the output with all rows in order, removes what was kept on the way, and returns what failed.
    pub(crate) fn finish(self) -> Result<Failures> {
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
        fs::write(&self.batch, format!("{}\n", self.identity.0)).with_context(context)?;
        fs::remove_file(&self.partial).with_context(context)?;
        let mut reasons: BTreeMap<&str, Reason> = BTreeMap::new();
        for (&first, cells) in self.rows.iter().filter(|(_, cells)| status(cells) != Some(OK)) {
            let Some(reason) = cells.last() else { continue };
            let known = reasons.entry(reason).or_insert_with(|| Reason { reason: reason.clone(), scenes: 0, first });
            known.scenes += 1;
        }
        let mut reasons: Vec<Reason> = reasons.into_values().collect();
        reasons.sort_by_key(|reason| std::cmp::Reverse(reason.scenes));
        Ok(Failures { count: reasons.iter().map(|reason| reason.scenes).sum(), reasons })
    }
}

/// Status in the cells of a row, which ends with it and the reason.
fn status(cells: &[String]) -> Option<&str> {
    cells.iter().rev().nth(1).map(String::as_str)
}

/// Scene and cells of a row.
fn cells(record: &csv::StringRecord) -> Result<(usize, Vec<String>)> {
    Ok((record.get(0).unwrap_or_default().parse()?, record.iter().skip(1).map(str::to_owned).collect()))
}

/// FNV-1a of bytes.
pub(crate) fn fingerprint(bytes: &[u8]) -> String {
    format!("{:016x}", bytes.iter().fold(Fnv::new(), |hash, &byte| hash.with(byte)).0)
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
        let identity = |inputs: &str| Identity::of(&[("scene", b"brake"), ("inputs", inputs.as_bytes())]);
        let own = &identity("a");
        let mut results = Results::open(&output, &header, own, &design, false).unwrap();
        results.add(&row(2, "")).unwrap();
        results.add(&row(0, "too hot, \"by far\"\nsee above")).unwrap();
        drop(results);
        let partial = folder.join("out.csv.partial");
        let whole = fs::read(&partial).unwrap();
        fs::write(&partial, [whole.as_slice(), b"1,0.1,1."].concat()).unwrap();

        let told = |identity: &Identity, design: &[Vec<String>]| {
            Results::open(&output, &header, identity, design, false).err().unwrap().to_string()
        };
        assert!(told(&identity("b"), &design).contains("another batch: inputs differ"));
        let others = told(own, &vec![vec!["0.2".to_owned()]; 3]);
        assert!(others.contains("1 of them, the first of scene 2") && others.contains("--replace"), "{others}");
        let mut results = Results::open(&output, &header, own, &design, false).unwrap();
        assert_eq!([0, 1, 2].map(|scene| results.has(scene)), [true, false, true]);
        let lines = |text: Vec<u8>| {
            let mut lines: Vec<String> = String::from_utf8(text).unwrap().lines().map(str::to_owned).collect();
            lines.sort();
            lines
        };
        assert_eq!(lines(fs::read(&partial).unwrap()), lines(whole));
        results.add(&row(1, "")).unwrap();
        let failures = results.finish().unwrap();
        let reason = Reason { reason: "too hot, \"by far\" see above".to_owned(), scenes: 1, first: 0 };
        assert_eq!(failures, Failures { count: 1, reasons: vec![reason] });
        assert_eq!(
            fs::read_to_string(&output).unwrap(),
            "scene,punch.width,wear_depth,status,reason\n\
             0,0.1,,stepping,\"too hot, \"\"by far\"\" see above\"\n1,0.1,1.5,ok,\n2,0.1,1.5,ok,\n"
        );
        assert!(!partial.exists());

        // A longer design continues it, and the row that failed may have other cells. Results that are there go only where that is said.
        let mut longer = vec![vec!["0.1".to_owned()]; 5];
        longer[0][0] = "0.7".to_owned();
        let known = |identity: &Identity, design: &[Vec<String>], replace: bool| {
            let results = Results::open(&output, &header, identity, design, replace).unwrap();
            let known: Vec<usize> = (0..5).filter(|scene| results.has(*scene)).collect();
            fs::remove_file(&partial).unwrap();
            fs::write(folder.join("out.csv.batch"), format!("{}\n", own.0)).unwrap();
            known
        };
        assert_eq!(known(own, &longer, false), [1, 2]);
        let mut changed = longer.clone();
        changed[1][0] = "0.8".to_owned();
        for design in [&changed[..], &longer[..1]] {
            let refused = told(own, design);
            assert!(refused.contains("the first of scene 1") && refused.contains("--replace"), "{refused}");
        }
        assert_eq!(known(own, &changed, true), [2]);
        assert!(told(&identity("b"), &longer).contains("another batch: inputs differ"));
        assert!(known(&identity("b"), &longer, true).is_empty());
        fs::remove_file(folder.join("out.csv.batch")).unwrap();
        assert!(told(own, &longer).contains("no result of a batch"));
        assert!(known(own, &longer, true).is_empty());
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn two_batches_do_not_write_one_output() {
        let folder = std::env::temp_dir().join(format!("batch-twice-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        let (output, partial) = (folder.join("out.csv"), folder.join("out.csv.partial"));
        let header = ["scene", "punch.width", "wear_depth", "status", "reason"].map(str::to_owned);
        let design = [vec!["0.1".to_owned()]];
        let open = || Results::open(&output, &header, &Identity::of(&[("scene", b"brake")]), &design, false);
        let mut first = open().unwrap();
        let told = open().err().unwrap().to_string();
        for part in
            [&partial.display().to_string(), "another `cargo fmu batch` that still runs", "name another --output"]
        {
            assert!(told.contains(part), "{told}");
        }
        first.add(&row(0, "")).unwrap();
        first.finish().unwrap();
        assert!(fs::read_to_string(&output).unwrap().ends_with("0,0.1,1.5,ok,\n"));
        assert!(open().unwrap().has(0));
        // What is refused leaves nothing.
        fs::write(folder.join("other.csv"), "mine").unwrap();
        let refused = Results::open(&folder.join("other.csv"), &header, &Identity::of(&[]), &design, false);
        assert!(refused.is_err() && !folder.join("other.csv.partial").exists());
        fs::remove_dir_all(&folder).unwrap();
    }
}
