import { useRef, useState } from 'react';
import type { BenchReport } from './bench-report.ts';
import { comparedCell, comparedRows, differencesOf, readBenchReport } from './compare-reports.ts';

/** A report beside others. */
interface Column {
  readonly id: number;
  readonly report: BenchReport;
}

/** Puts saved reports of other devices, or of this one, beside this report. */
export function CompareSection({ report }: { report: BenchReport }) {
  const [others, setOthers] = useState<readonly Column[]>([]);
  const nextId = useRef(1);
  const [problem, setProblem] = useState('');
  const input = useRef<HTMLInputElement>(null);
  const add = async (files: readonly File[]) => {
    setProblem('');
    try {
      const read = await Promise.all(
        files.map(async (file) => readBenchReport(await file.text(), file.name)),
      );
      const columns = read.map((each) => ({ id: nextId.current++, report: each }));
      setOthers((before) => [...before, ...columns]);
    } catch (error) {
      setProblem(error instanceof Error ? error.message : String(error));
    }
  };
  return (
    <section aria-labelledby="bench-others">
      <h2 id="bench-others">Beside other reports</h2>
      <div className="page-actions">
        <button
          type="button"
          className="text-button outlined"
          data-testid="bench-compare"
          onClick={() => input.current?.click()}
        >
          Add saved reports
        </button>
        {others.length > 0 && (
          <button type="button" className="text-button outlined" onClick={() => setOthers([])}>
            Remove them
          </button>
        )}
        <input
          ref={input}
          type="file"
          accept=".json,application/json"
          multiple
          hidden
          data-testid="bench-reports"
          onChange={(event) => {
            void add([...(event.target.files ?? [])]);
            // So that choosing the same file again is a change.
            event.target.value = '';
          }}
        />
      </div>
      <p role="status">{problem}</p>
      {others.length > 0 && <ComparedTable columns={[{ id: 0, report }, ...others]} />}
    </section>
  );
}

function ComparedTable({ columns }: { columns: readonly Column[] }) {
  const [first, ...others] = columns;
  const rows = comparedRows(columns.map(({ report }) => report));
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: what scrolls by itself must be reachable by keys.
    <section className="page-table" tabIndex={0} aria-label="Medians of all reports">
      <table data-testid="bench-compared">
        <thead>
          <tr>
            <th scope="col">Median ms</th>
            <th scope="col">This one</th>
            {others.map(({ id, report }) => (
              <th key={id} scope="col">
                {report.measurement.adapter}
                <Differences names={differencesOf(first.report, report)} />
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.map(({ name, mediansMs }) => (
            <tr key={name}>
              <th scope="row">{name}</th>
              {columns.map(({ id }, column) => (
                <td key={id}>{comparedCell(mediansMs[column], mediansMs[0])}</td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

/** What keeps two reports from being compared. */
function Differences({ names }: { names: readonly string[] }) {
  if (names.length === 0) return null;
  return <p className="bench-differs">Not the same {names.join(', ').toLowerCase()}</p>;
}
