export { HARD_CASES } from './catalogue.ts';
export { chooseCases } from './choose-cases.ts';
export * from './hard-case.ts';
export {
  type CaseVerdict,
  type KeptRun,
  keepRun,
  keptRun,
  keptSentence,
  unrunFirst,
  verdictOn,
} from './kept-run.ts';
export { ORDINARY_SCENE } from './make-cases.ts';
export { MUTATIONS, type Mutation } from './mutations.ts';
export {
  failureLines,
  type HardCaseReport,
  jsonReport,
  markdownReport,
  type ReportPlace,
  resultHeading,
  resultLine,
  summaryLine,
  textReport,
} from './report.ts';
export { HardCaseRunner, type HardCaseRunnerOptions, type HardCaseRunOptions } from './run.ts';
export { DEFAULT_SIZE_PX, type HardCasesOptions, runHardCases } from './run-all.ts';
export { type ImageTarget, minPsnrOf } from './run-images.ts';
export {
  CASE_RASTERIZERS,
  type HardCaseResult,
  type ImageResult,
  type ImageResults,
  MIN_REFERENCE_PSNR_DB,
  type StageError,
} from './run-result.ts';
export { type SoakOptions, type SoakReport, soak } from './soak/soak.ts';
export { truncatesHalves } from './truncates-halves.ts';
