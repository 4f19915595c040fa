/** The bench that the runner is loaded for; `packages/tools/bench.mjs` says which file it is. */
declare module 'virtual:bench' {
  const bench:
    | import('./bench.ts').NodeBench<unknown>
    | import('./bench.ts').PageBench<import('./options.ts').CommonOptions>;
  export default bench;
}
