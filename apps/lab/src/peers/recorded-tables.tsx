import { Fragment, type ReactNode } from 'react';
import current from '../../../../evidence/web-renderers.json';
import ofThePaper from '../../../../evidence/web-renderers-of-the-paper.json';
import type { Evidence, EvidenceRun, EvidenceTable } from '../../../docs/src/build/evidence.ts';
import { CellTable } from '../page.tsx';
import { NONE } from './runner/report.ts';

/** Heading of the column of ratios. */
const RATIO = '×';

/** Recorded runs of `bench:peers`, as the documentation shows them. */
const RECORDED: readonly Evidence[] = [current, ofThePaper];

/** Recorded times of other renderers, labelled as those of another machine. */
export function RecordedTables() {
  return (
    <section aria-labelledby="recorded">
      <h2 id="recorded">Recorded on one machine, not on this device</h2>
      <p>
        <b>Correct frame</b>: ms, median / P99, from the jump of the camera to the end of a frame in the order
        of the new view. <b>×</b>: how many times as long as WebSplatter’s on the same machine. <b>PSNR</b>:
        against float64; a renderer that leaves splats out has less.
      </p>
      {RECORDED.map((evidence) => (
        <RecordedTable key={evidence.title} evidence={evidence} />
      ))}
    </section>
  );
}

function RecordedTable({ evidence }: { evidence: Evidence }) {
  const { title, conclusion, run, runs = run ? [run] : [], tables = [], remarks = [] } = evidence;
  return (
    <section aria-label={title}>
      <h3>{title}</h3>
      <p>{conclusion}</p>
      <ul>
        {runs.map((each) => (
          <li key={each.commit}>Recorded: {runFacts(each)}</li>
        ))}
      </ul>
      {tables.map((table) => (
        <Fragment key={table.caption}>
          <h4>{table.caption}</h4>
          <CellTable label={`${title}: ${table.caption}`} rows={rowsOf(table)} />
        </Fragment>
      ))}
      <details>
        <summary>How it was measured</summary>
        {remarks.map((remark) => (
          <p key={remark} className="muted">
            {withoutMarks(remark)}
          </p>
        ))}
      </details>
    </section>
  );
}

/** Cells, the heading first; ratios beside the names, where narrow windows show them, too. */
function rowsOf({ columns, rows }: EvidenceTable): ReactNode[][] {
  const ratio = columns.indexOf(RATIO);
  return [columns, ...rows].map((row) => {
    const cells = row.map((cell) => (typeof cell === 'number' ? cell.toLocaleString('en') : (cell ?? NONE)));
    return ratio < 0 ? cells : [cells[0], cells[ratio], ...cells.slice(1, ratio), ...cells.slice(ratio + 1)];
  });
}

function runFacts({ machine, adapter, driver, browser, date, commit, command }: EvidenceRun): string {
  return [
    machine,
    adapter && `adapter ${adapter}`,
    driver,
    browser,
    date ?? 'no date',
    commit && `commit ${commit}`,
    command,
  ]
    .filter(Boolean)
    .join('; ');
}

/** Text of a remark, which is Markdown without links. */
function withoutMarks(remark: string): string {
  return remark.replace(/\*\*|`/g, '');
}
