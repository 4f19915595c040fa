import type { CaseVerdict as Verdict } from '@websplatter/conformance';
import { saveFile, useCopy } from '@websplatter/kit/take-away';
import type { ReactNode } from 'react';

/** The viewer, which the lab lies beside. */
export const VIEWER = '../';

/** The gallery of hard cases. */
export const GALLERY = '?gallery';

/** The page of a hard case, which shows the expected image beside this device's. */
export function caseAddress(name: string): string {
  return `${GALLERY}&case=${encodeURIComponent(name)}`;
}

export type PageName = 'gallery' | 'conformance' | 'bench' | 'peers';

/** In the address, by `name`. */
export const PAGES: readonly { readonly name: PageName; readonly title: string; readonly about: string }[] = [
  {
    name: 'gallery',
    title: 'Hard cases',
    about: 'Scenes that break splat renderers, each as float64 defines it and as this device draws it.',
  },
  {
    name: 'conformance',
    title: 'Conformance',
    about: 'Scenes that break splat renderers, each drawn on this GPU and compared with float64.',
  },
  {
    name: 'bench',
    title: 'Benchmark',
    about:
      'Frames of a scene along the same path, in the same size and with the same settings on every device.',
  },
  {
    name: 'peers',
    title: 'Other renderers',
    about:
      'This project compared with other splat renderers: the same scene, cameras and size, in one browser.',
  },
];

/** Links to all pages of the lab, and to the viewer. */
export function LabLinks({ current }: { readonly current: PageName | null }) {
  return (
    <nav className="lab-links" aria-label="Lab">
      <a href="./" aria-current={current === null ? 'page' : undefined}>
        WebSplatter lab
      </a>
      {PAGES.map(({ name, title }) => (
        <a key={name} href={`?${name}`} aria-current={name === current ? 'page' : undefined}>
          {title}
        </a>
      ))}
      <a href={VIEWER}>Viewer</a>
    </nav>
  );
}

/** A page of the lab. */
export function LabPage(props: {
  readonly name: PageName | null;
  readonly title: string;
  readonly about: ReactNode;
  readonly children: ReactNode;
}) {
  return (
    <>
      <LabLinks current={props.name} />
      <main data-testid={props.name}>
        <header>
          <h1>{props.title}</h1>
          <p>{props.about}</p>
        </header>
        {props.children}
      </main>
    </>
  );
}

/** Whether a hard case passes on this device, as far as it has run there. */
export function CaseVerdict({ verdict }: { readonly verdict: Verdict }) {
  return (
    <span className="verdict" data-verdict={verdict ?? 'none'}>
      {verdict === null ? 'not run on this device' : verdict === 'pass' ? '✓ passes' : '✕ fails'}
    </span>
  );
}

/** A table that scrolls by itself: headings, then `wordColumns` columns of words, then figures. */
export function CellTable(props: {
  readonly label: string;
  readonly rows: readonly (readonly ReactNode[])[];
  readonly wordColumns?: number;
  readonly testId?: string;
}) {
  const { label, rows, wordColumns = 1, testId } = props;
  const [heading, ...body] = rows;
  const classOf = (column: number) => (column < wordColumns ? 'word' : undefined);
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: keys must reach a box that scrolls.
    <section className="table" tabIndex={0} aria-label={label}>
      <table data-testid={testId}>
        <thead>
          <tr>
            {heading.map((cell, column) => (
              // biome-ignore lint/suspicious/noArrayIndexKey: columns do not move.
              <th key={column} scope="col" className={classOf(column)}>
                {cell}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {body.map((cells, row) => (
            // biome-ignore lint/suspicious/noArrayIndexKey: rows do not move.
            <tr key={row}>
              {cells.map((cell, column) => {
                const Cell = column === 0 ? 'th' : 'td';
                return (
                  // biome-ignore lint/suspicious/noArrayIndexKey: columns do not move.
                  <Cell key={column} scope={column === 0 ? 'row' : undefined} className={classOf(column)}>
                    {cell}
                  </Cell>
                );
              })}
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

/** How far something is. */
export function Progress(props: {
  readonly label: string;
  readonly done: number | undefined;
  readonly children: ReactNode;
}) {
  return (
    <section className="progress" aria-label="Progress">
      <progress aria-label={props.label} value={props.done} max={1} />
      <p data-testid="progress">{props.label}</p>
      {props.children}
    </section>
  );
}

/** A report that a person can take along. */
export interface TakenReport {
  /** Format of the copy: `text`, `JSON`. */
  readonly format: string;
  readonly text: () => string;
  /** Parts of the file's name, if the report can be saved too. */
  readonly fileName?: readonly string[];
}

/** Buttons that copy and save reports; shows the text if the browser forbids copying. */
export function TakeReports({ reports }: { readonly reports: readonly TakenReport[] }) {
  const { copy, status, uncopied, area } = useCopy();
  return (
    <div className="buttons">
      {reports.map((report) => (
        <button key={report.format} type="button" onClick={() => void copy(report.text(), report.format)}>
          Copy as {report.format}
        </button>
      ))}
      {reports.map(
        ({ format, text, fileName }) =>
          fileName && (
            <button
              key={format}
              type="button"
              onClick={() => saveFile(new Blob([text()], { type: 'application/json' }), fileNameOf(fileName))}
            >
              Save {format}
            </button>
          ),
      )}
      <p role="status" data-testid="copied">
        {status}
      </p>
      {uncopied && <textarea ref={area} readOnly rows={8} aria-label="Report" value={uncopied} />}
    </div>
  );
}

/** The name of a JSON file, without characters that file systems refuse. */
export function fileNameOf(words: readonly string[]): string {
  return `${words.join(' ').replaceAll(/[^\p{L}\p{N}]+/gu, '-')}.json`;
}
