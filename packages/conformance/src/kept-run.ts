import { HARD_CASES } from './catalogue.ts';
import type { HardCaseReport } from './report.ts';

/** Key in local storage, which all pages of an origin share. */
const KEY = 'websplatter-hard-cases';

/** Verdicts of the cases that ran in this browser with one version on one adapter. */
export interface KeptRun extends Pick<HardCaseReport, 'version' | 'commit' | 'adapter'> {
  /** Date of the last run, ISO 8601. */
  readonly date: string;
  /** Names of cases, by their last verdict. */
  readonly passed: readonly string[];
  readonly failed: readonly string[];
}

/** Returns the kept run; null if there is none, or if storage is closed to the page. */
export function keptRun(storage = ownStorage()): KeptRun | null {
  try {
    const kept = JSON.parse(storage?.getItem(KEY) ?? 'null') as KeptRun | null;
    return kept && Array.isArray(kept.passed) && Array.isArray(kept.failed) ? kept : null;
  } catch {
    // What is stored is no JSON, or storage is closed: all cases run.
    return null;
  }
}

/** Stores the verdicts of a run, and keeps earlier verdicts of other cases; returns all. */
export function keepRun(report: HardCaseReport, storage = ownStorage()): KeptRun {
  const { version, commit, adapter, date, results } = report;
  const before = keptRun(storage);
  const isSame = before?.version === version && before.commit === commit && before.adapter === adapter;
  const ran = new Set(results.map(({ name }) => name));
  const namesOf = (verdict: string, others: readonly string[] = []) => [
    ...(isSame ? others : []).filter((name) => !ran.has(name)),
    ...results.filter((result) => result.verdict === verdict).map(({ name }) => name),
  ];
  const passed = namesOf('pass', before?.passed);
  const kept: KeptRun = { version, commit, adapter, date, passed, failed: namesOf('fail', before?.failed) };
  try {
    storage?.setItem(KEY, JSON.stringify(kept));
  } catch {
    // Storage is full, or closed to the page.
  }
  return kept;
}

/** Result of a case on this device; null if it has not run. */
export type CaseVerdict = 'pass' | 'fail' | null;

/** The last verdict of a case; null if it has not run. */
export function verdictOn(name: string, kept: KeptRun | null): CaseVerdict {
  if (kept?.passed.includes(name)) return 'pass';
  return kept?.failed.includes(name) ? 'fail' : null;
}

/** `316 of 316 cases pass on this device`, `3 of 316 …: 2 fail, 311 have not run`. */
export function keptVerdict({ passed, failed }: KeptRun, names = HARD_CASES.map(({ name }) => name)): string {
  const [passes, fails] = [passed, failed].map((some) => names.filter((name) => some.includes(name)).length);
  const others = [
    ...(fails > 0 ? [`${fails} ${fails === 1 ? 'fails' : 'fail'}`] : []),
    ...(passes + fails < names.length ? [`${names.length - passes - fails} have not run`] : []),
  ];
  const verdict = `${passes} of ${names.length} cases pass on this device`;
  return others.length > 0 ? `${verdict}: ${others.join(', ')}` : verdict;
}

/** A sentence with the verdict, the version and the date of the run. */
export function keptSentence(kept: KeptRun): string {
  return `${keptVerdict(kept)}, by version ${kept.version}, ${new Date(kept.date).toLocaleDateString()}.`;
}

/** Returns the cases, the ones that have not run first. */
export function unrunFirst<Case extends { readonly name: string }>(
  cases: readonly Case[],
  kept: KeptRun | null,
): Case[] {
  const hasRun = ({ name }: Case) => verdictOn(name, kept) !== null;
  return cases.toSorted((a, b) => Number(hasRun(a)) - Number(hasRun(b)));
}

function ownStorage(): Pick<Storage, 'getItem' | 'setItem'> | undefined {
  try {
    return globalThis.localStorage;
  } catch {
    // The page may not use storage: nothing is kept.
    return undefined;
  }
}
