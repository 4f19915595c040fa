// Runs the hard cases whose names the address gives (`?cases=scale-unit,sort-0-keys`), or all of them. For tests and other
// observers of the page, the document's `data-state` is `idle`, `running`, `done` or `failed`, and `report` is the result.
import {
  HARD_CASES,
  type HardCaseReport,
  jsonReport,
  runHardCases,
  textReport,
} from '@websplatter/hardcases';

declare global {
  interface Window {
    report?: HardCaseReport;
  }
  /** Version of WebSplatter and commit of the working copy, which the build puts in. */
  const WEBSPLATTER_BUILD: { readonly version: string; readonly commit: string | null };
}

const element = (id: string) => document.getElementById(id)!;
const { dataset } = document.documentElement;
const runButton = element('run') as HTMLButtonElement;

const names = new URLSearchParams(location.search).get('cases')?.split(',');
const cases = names ? HARD_CASES.filter(({ name }) => names.includes(name)) : HARD_CASES;

async function run(): Promise<void> {
  runButton.disabled = true;
  dataset.state = 'running';
  let done = 0;
  let failed = 0;
  const showProgress = () => {
    element('progress').textContent =
      `${done} of ${cases.length} cases${failed > 0 ? `, ${failed} failed` : ''}`;
  };
  showProgress();
  try {
    const report = await runHardCases({
      gpu: navigator.gpu,
      cases,
      place: { program: navigator.userAgent, ...WEBSPLATTER_BUILD },
      onResult: ({ verdict }) => {
        done++;
        if (verdict === 'fail') failed++;
        showProgress();
      },
    });
    window.report = report;
    element('report').textContent = textReport(report);
    element('result').hidden = false;
    dataset.state = 'done';
  } catch (error) {
    element('progress').textContent = error instanceof Error ? error.message : String(error);
    dataset.state = 'failed';
  }
  runButton.disabled = false;
}

for (const [id, format] of [
  ['copy-text', textReport],
  ['copy-json', jsonReport],
] as const) {
  element(id).addEventListener('click', () => void navigator.clipboard.writeText(format(window.report!)));
}
runButton.addEventListener('click', () => void run());
if (!navigator.gpu) {
  runButton.disabled = true;
  element('progress').textContent = 'This browser has no WebGPU, or not for this page.';
  dataset.state = 'failed';
} else dataset.state = 'idle';
