//! Cells of a file as text, with the line that each row stands in.

/// Rows of cells, in two long vectors: a file of a million rows makes no million texts.
#[derive(Debug, Default)]
pub(crate) struct Table {
    text: String,
    /// End of each cell in `text`.
    ends: Vec<usize>,
    /// End of each row in `ends`, and its line.
    rows: Vec<(usize, usize)>,
}

/// One row of a [`Table`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row<'a> {
    table: &'a Table,
    /// Its cells in `ends`.
    first: usize,
    end: usize,
    /// Line of the file (from 1) as an editor shows it; of a workbook the number of the row.
    pub line: usize,
}

impl Table {
    /// Adds a cell to the row that is being filled, without the blanks around it.
    pub fn push(&mut self, cell: &str) {
        self.text.push_str(cell.trim());
        self.ends.push(self.text.len());
    }

    /// Ends the row that is being filled.
    pub fn end_row(&mut self, line: usize) {
        self.rows.push((self.ends.len(), line));
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// A row; an empty one where there is none.
    pub fn row(&self, at: usize) -> Row<'_> {
        let start = |at: usize| at.checked_sub(1).and_then(|before| self.rows.get(before)).map_or(0, |(end, _)| *end);
        let (end, line) = self.rows.get(at).copied().unwrap_or((start(at), 0));
        Row { table: self, first: start(at), end, line }
    }

    /// All rows from one on.
    pub fn rows_from(&self, at: usize) -> impl Iterator<Item = Row<'_>> {
        (at..self.len()).map(|at| self.row(at))
    }
}

impl<'a> Row<'a> {
    /// Number of cells.
    pub fn len(self) -> usize {
        self.end - self.first
    }

    /// The cell at a place from 0; empty where the row has ended.
    pub fn cell(self, at: usize) -> &'a str {
        let at = self.first + at;
        if at >= self.end {
            return "";
        }
        let start = at.checked_sub(1).map_or(0, |before| self.table.ends[before]);
        &self.table.text[start..self.table.ends[at]]
    }

    /// All cells.
    pub fn cells(self) -> impl Iterator<Item = &'a str> {
        (0..self.len()).map(move |at| self.cell(at))
    }

    /// No cell holds anything.
    pub fn is_blank(self) -> bool {
        self.cells().all(str::is_empty)
    }
}
