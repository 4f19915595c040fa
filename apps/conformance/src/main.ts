// Runs the hard cases whose names the address gives (`?cases=scale-unit,sort-0-keys`), or all of them. For tests and other
// observers of the page, the document's `data-state` is `idle`, `running`, `done` or `failed`, and `report` is the result.
import {
  chooseCases,
  HARD_CASES,
  type HardCase,
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
const [runButton, stopButton, bar] = [element('run'), element('stop'), element('bar') as HTMLProgressElement];
let stopper: AbortController | null = null;

/** A button that is disabled so keeps the focus. */
function setDisabled(button: HTMLElement, isDisabled: boolean): void {
  button.ariaDisabled = String(isDisabled);
}

function endAs(state: 'done' | 'failed', outcome: string, isGood = false): void {
  element('outcome').textContent = outcome;
  element('outcome').classList.toggle('bad', !isGood);
  dataset.state = state;
}

async function run(cases: readonly HardCase[]): Promise<void> {
  stopper = new AbortController();
  setDisabled(runButton, true);
  setDisabled(stopButton, false);
  stopButton.hidden = false;
  element('running').hidden = false;
  element('result').hidden = true;
  element('copied').textContent = '';
  element('outcome').textContent = '';
  delete window.report;
  dataset.state = 'running';
  let done = 0;
  let failed = 0;
  const showProgress = () => {
    bar.max = cases.length;
    bar.value = done;
    element('count').textContent =
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
      signal: stopper.signal,
    });
    window.report = report;
    const text = textReport(report);
    element('report-text').textContent = text;
    element('result').hidden = false;
    const [headline] = text.replace('WebSplatter: ', '').split('\n');
    endAs('done', failed > 0 ? `${headline}, ${failed} failed.` : `${headline}.`, failed === 0);
    element('result-heading').focus();
  } catch (error) {
    endAs('failed', error instanceof Error ? error.message : String(error));
    runButton.focus();
  }
  stopper = null;
  setDisabled(runButton, false);
  stopButton.hidden = true;
  element('running').hidden = true;
}

/** Copies a text, or shows and selects it where the browser does not let the page copy. */
async function copy(text: string): Promise<void> {
  const copied = element('copied');
  copied.textContent = '';
  try {
    await navigator.clipboard.writeText(text);
    copied.textContent = 'Copied';
  } catch {
    element('report-text').textContent = text;
    getSelection()?.selectAllChildren(element('report-text'));
    copied.textContent = 'The browser does not let the page copy: copy the selected text';
  }
}

/** Says what would run, and where that fails, what is wrong. */
function chosenCases(): readonly HardCase[] | null {
  const names = new URLSearchParams(location.search).get('cases');
  const choice = element('choice');
  if (!names) {
    choice.textContent = `${HARD_CASES.length} cases.`;
    return HARD_CASES;
  }
  const all = Object.assign(document.createElement('a'), { href: './', textContent: 'Choose all' });
  try {
    const cases = chooseCases(names.split(','));
    const list = cases.map(({ name }) => name).join(', ');
    choice.append(`${cases.length} chosen of ${HARD_CASES.length}: ${list}. `, all);
    return cases;
  } catch (error) {
    choice.append(all);
    endAs('failed', (error as Error).message);
    return null;
  }
}

for (const [id, format] of [
  ['copy-text', textReport],
  ['copy-json', jsonReport],
] as const) {
  element(id).addEventListener('click', () => void copy(format(window.report!)));
}
stopButton.addEventListener('click', () => {
  if (stopper?.signal.aborted) return;
  stopper?.abort();
  setDisabled(stopButton, true);
  element('count').textContent += ', stopping after this case …';
});

const cases = chosenCases();
if (!navigator.gpu) endAs('failed', 'This browser has no WebGPU, or not for this page.');
if (cases && navigator.gpu) {
  runButton.addEventListener('click', () => {
    if (!stopper) void run(cases);
  });
  dataset.state = 'idle';
} else setDisabled(runButton, true);
