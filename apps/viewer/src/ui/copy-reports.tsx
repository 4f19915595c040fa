import { useRef, useState } from 'react';
import { download } from '../saving/download.ts';

/** A report that a person can take along. */
export interface CopyableReport {
  /** What it is copied as: `text`, `JSON`. */
  readonly format: string;
  readonly text: () => string;
  /** Where it can be saved too: the file's name. */
  readonly fileName?: string;
}

/** Buttons that copy reports and save them; where the browser does not let the page copy, shows the text to be copied by hand. */
export function CopyReports({ reports, testId }: { reports: readonly CopyableReport[]; testId: string }) {
  const [said, setSaid] = useState('');
  /** What the browser does not let the page copy. */
  const [uncopied, setUncopied] = useState('');
  const area = useRef<HTMLTextAreaElement>(null);
  const copy = async ({ format, text }: CopyableReport) => {
    const report = text();
    setUncopied('');
    try {
      await navigator.clipboard.writeText(report);
      setSaid(`Copied as ${format}`);
    } catch {
      setSaid('The browser does not let the page copy: copy the selected text');
      setUncopied(report);
      requestAnimationFrame(() => area.current?.select());
    }
  };
  return (
    <div className="copy-reports">
      {reports.map((report) => (
        <button
          key={report.format}
          type="button"
          className="text-button outlined"
          data-testid={`${testId}-copy-${report.format.toLowerCase()}`}
          onClick={() => void copy(report)}
        >
          Copy as {report.format}
        </button>
      ))}
      {reports.map(
        ({ format, text, fileName }) =>
          fileName !== undefined && (
            <button
              key={fileName}
              type="button"
              className="text-button outlined"
              data-testid={`${testId}-save-${format.toLowerCase()}`}
              onClick={() => download(new Blob([text()], { type: 'application/json' }), fileName)}
            >
              Save {format}
            </button>
          ),
      )}
      <p role="status" data-testid={`${testId}-copied`}>
        {said}
      </p>
      {uncopied && (
        <textarea
          ref={area}
          readOnly
          rows={8}
          aria-label="Report"
          data-testid={`${testId}-report`}
          value={uncopied}
        />
      )}
    </div>
  );
}
