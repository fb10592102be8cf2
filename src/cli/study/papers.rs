//! What a study leaves behind: its page, its figures, and a few words.

use std::path::Path;

use anyhow::{Result, bail};
use serde::Serialize;

use crate::cli::complain;
use crate::cli::output::{self, Output};

/// Where a study's page and figures go.
#[derive(Clone, Copy, Debug)]
pub struct Papers<'a> {
    page: &'a Path,
    json: Option<&'a Path>,
}

/// Refuses a budget with which there is nothing to begin.
pub fn check_budget(budget: f64) -> Result<()> {
    if !(budget > 0.0 && budget.is_finite()) {
        bail!("--budget {budget} leaves no time; give a number of seconds");
    }
    Ok(())
}

impl<'a> Papers<'a> {
    /// Finds out early whether the files can be written, and no more: whoever stops the study in the
    /// middle shall not find unfinished ones.
    pub fn new(page: &'a Path, json: Option<&'a Path>) -> Result<Self> {
        output::must_differ(Some(page), json)?;
        let papers = Self { page, json };
        papers
            .paths()
            .try_for_each(|path| Output::create(path).map(drop))?;
        Ok(papers)
    }

    fn paths(&self) -> impl Iterator<Item = &'a Path> {
        [Some(self.page), self.json].into_iter().flatten()
    }

    /// Writes both, or neither.
    pub fn write(&self, page: &str, figures: &impl Serialize) -> Result<()> {
        let mut html = Output::create(self.page)?;
        html.write(|out| out.write_all(page.as_bytes()))?;
        let mut files = vec![html];
        if let Some(path) = self.json {
            let mut json = Output::create(path)?;
            json.write(|out| {
                serde_json::to_writer_pretty(&mut *out, figures)?;
                writeln!(out)
            })?;
            files.push(json);
        }
        output::commit(files)
    }

    /// Says something on standard output, or on standard error where that takes a file.
    pub fn say(&self, text: &str) -> Result<()> {
        if self.paths().any(output::is_stdout) {
            complain(text.trim_end());
            return Ok(());
        }
        output::print(text)
    }
}
