import { useRef, useState } from 'react';
import { CellTable, LabPage } from '../page.tsx';
import type { Report } from './frames/report.ts';
import { reportLegend, reportParts } from './frames/table.ts';
import { RecordedTables } from './recorded-tables.tsx';
import { reportFacts } from './runner/report.ts';

/** This project beside other renderers (`?peers`): recorded tables, how to measure, and tables of a report. */
export default function PeersPage() {
  const [report, setReport] = useState<Report | null>(null);
  const [problem, setProblem] = useState('');
  const input = useRef<HTMLInputElement>(null);
  const open = async (file: File | undefined) => {
    if (!file) return;
    setProblem('');
    try {
      const read: Report = JSON.parse(await file.text());
      // Anything that can be shown is a report.
      reportParts(read);
      setReport(read);
    } catch {
      setProblem(
        `${file.name} is not a report of other renderers. Choose a file written by npm run bench:peers -- --json FILE.`,
      );
    }
  };
  return (
    <LabPage
      name="peers"
      title="Other renderers"
      about="Every renderer draws the same scene, cameras, size and background in the same browser, through its public interface. Each frame is drawn to its end. Each picture is compared with float64, so that no renderer is fast by drawing less."
    >
      <RecordedTables />
      <section aria-labelledby="measure">
        <h2 id="measure">Measure on your machine</h2>
        <p>
          The renderers are not part of this page. A command of the repository fetches them and measures each
          in a browser of its own.
        </p>
        {/* biome-ignore lint/a11y/noNoninteractiveTabindex: keys must reach a box that scrolls. */}
        <pre tabIndex={0}>npm run bench:peers -- --synthetic 1000000 --json peers.json</pre>
      </section>
      <section aria-labelledby="report">
        <h2 id="report">Read a report</h2>
        <div className="buttons">
          <button type="button" className="primary" onClick={() => input.current?.click()}>
            Open peers.json
          </button>
          <input
            ref={input}
            type="file"
            accept=".json,application/json"
            hidden
            data-testid="reports"
            onChange={(event) => {
              void open(event.target.files?.[0]);
              // So that choosing the same file again is a change.
              event.target.value = '';
            }}
          />
        </div>
        <p role="status">{problem}</p>
      </section>
      {report && <PeerTables report={report} />}
    </LabPage>
  );
}

function PeerTables({ report }: { report: Report }) {
  return (
    <>
      {reportParts(report).map(({ heading, rows, notes }) => (
        <section key={heading} aria-label={heading} data-testid="part">
          <h2>{heading}</h2>
          <CellTable label={`Table of ${heading}`} rows={rows} wordColumns={2} />
          <ul>
            {notes.map((note) => (
              <li key={note}>{note}</li>
            ))}
          </ul>
        </section>
      ))}
      <section className="muted" aria-label="What was measured">
        {[...reportFacts(report), ...reportLegend(report)].map((line) => (
          <p key={line}>{line}</p>
        ))}
      </section>
    </>
  );
}
