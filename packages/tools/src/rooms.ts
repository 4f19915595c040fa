// Who may import whom. import-rule.test.ts enforces it; type-only imports count like any other.
//
// A line names what it may import, and only what stands above it, so there can be no circles. `name(types)` allows
// `import type` only; `name(tests)` allows only tests to import it. The test also fails where a folder has no line and
// where nothing needs an arrow any more.

export type Arrows = Readonly<Record<string, string>>;

/** Rooms that all others may import without saying so. */
export const FOR_ALL_ROOMS = ['errors.ts', 'given.ts', 'number-of.ts', 'printable.ts', 'turns.ts'] as const;

/**
 * The rooms of packages/core/src: folders, and files at its root. Tests and testing/ may import all of them, and nothing
 * else may import those.
 */
export const ROOMS: Arrows = {
  /** Text from outside, fit for messages. */
  'printable.ts': '',
  /** Every error that is thrown on purpose. */
  'errors.ts': '',
  /** Options that are none, refused by name. */
  'given.ts': '',
  /** Numbers for objects, for keys made of text. */
  'number-of.ts': '',
  /** Turns of the event loop during long work. */
  'turns.ts': '',
  /** Vectors and matrices, in float64. */
  math: '',
  /** Every struct and constant that CPU and GPU share, defined once. */
  layout: '',
  /** Splats as data: columns on the CPU, as they were trained. */
  splats: '',
  /** Splats as the GPU reads them: precisions, storage order, chunks with bounds. */
  packing: 'splats layout math',
  /** Changes of whole sets on the CPU: merging, cropping, moving, fewer harmonics. */
  editing: 'packing splats math',
  /** File formats, and reading them in a worker. */
  io: 'packing splats layout math',
  /** Every setting, cutoff and preset of accuracy. */
  accuracy: 'packing layout',
  /** Cameras, and each cloud as a camera sees it. */
  camera: 'math',
  /** Links WGSL from modules, conditions and constants. */
  shaders: 'accuracy layout',
  /** Device, memory and pipelines. */
  gpu: 'shaders layout',
  /** Effects that callers ask for, a folder each; references and options in it belong to the rooms of their names. */
  effects: 'gpu shaders camera packing splats layout math',
  /** What people choose of effects: the interface of `@websplatter/core/effect-options`. */
  options: 'effects math',
  /** What frames take: GPU timestamps and their statistics. */
  timing: 'gpu accuracy(types) layout',
  /** Host sides of the shaders in shaders/stages, under the same basenames. */
  stages: 'effects gpu shaders camera accuracy packing splats layout',
  /** Clouds on the GPU: their planes, and rays through them. */
  clouds: 'stages gpu camera accuracy io packing splats layout math',
  /** Files' rows that become clouds on the GPU itself. Loaded only when a file has such rows. */
  ingest: 'clouds stages gpu io packing splats layout math',
  /** One frame: what it needs, its buffers and the order of its stages. */
  frame: 'clouds stages timing effects gpu camera accuracy packing splats layout math',
  /** All effects of a frame, each with the reason why it takes part or not. */
  ledger: 'frame effects layout math',
  /** The references: what every stage must compute, in float64, without a GPU. */
  reference: 'effects camera accuracy packing splats layout math',
  /** Single stages of a frame, read back and held against the references. */
  inspect:
    'reference frame clouds stages effects gpu shaders camera accuracy packing splats layout math',
  /** What settings and effects cost in time, and in error. */
  measure: 'reference ledger frame clouds stages timing effects gpu camera accuracy packing layout math',
  /** Views: frames on a canvas or inside of another renderer. What measures is loaded only when it is asked for. */
  views: 'measure(types) ledger frame clouds stages timing gpu camera accuracy layout math',
  /** Changing splats and writing them as files: the interface of `@websplatter/core/write`. */
  'write.ts': 'editing io',
  /** Splats from arrays, and edits of splats: the interface of `@websplatter/core/own-data`. */
  'own-data.ts': 'clouds editing packing splats',
  /** Coarse meshes of clouds, for physics: the interface of `@websplatter/core/collider`. */
  collider: 'clouds packing layout math',
  /** All workers in one script: the file `@websplatter/core/load-worker`. */
  'load-worker.ts': 'collider clouds io',
  /** What callers give besides requests of frames. */
  'check-options.ts': 'clouds(types) packing',
  /** The engine: one device, its clouds and its views. */
  'engine.ts':
    'check-options.ts views measure ledger frame ingest clouds gpu shaders accuracy io packing splats',
  /** Checks options, and fetches the engine's code while a device is asked for. */
  'create-engine.ts': 'engine.ts check-options.ts gpu shaders accuracy io',
  /** The public interface. */
  'index.ts':
    'create-engine.ts engine.ts(types) views measure ledger frame clouds timing gpu camera accuracy io packing splats math',
};

/** Packages and apps by folder name. Each line agrees with the dependencies of its package.json. */
export const PACKAGES: Arrows = {
  /** Chores of this repository. */
  tools: '',
  /** WGSL only. */
  shaders: '',
  /** The engine. */
  core: 'shaders node(tests) scenes(tests)',
  /** Scenes made by code. */
  scenes: 'core',
  /** WebGPU and files in Node. */
  node: 'core',
  /** Scenes that break splat renderers, and what is right for each. */
  hardcases: 'core shaders(tests) node(tests)',
  /** Splats in three.js. */
  three: 'core',
  /** Splats in react-three-fiber. */
  react: 'three core',
  /** Charts and tables of what was measured, for the terminal and for pages. */
  charts: 'core',
  /** The command line. */
  cli: 'charts hardcases node scenes core',
  /** The viewer; nothing imports an app. */
  viewer: 'charts hardcases scenes core',
  /** Examples for react-three-fiber. */
  examples: 'react scenes core',
  /** The documentation site, with examples that readers edit. */
  docs: 'react three scenes core',
  /** Hard cases and benchmark in any browser, and this project beside other renderers. */
  lab: 'charts hardcases three scenes node core tools',
  /** Apps and packages in a browser. */
  e2e: 'tools(tests) react(tests) three(tests) hardcases(tests) scenes(tests) core(tests) node(tests)',
};

/** Files that reach into another package by path, and why. All others import what a package exports. */
export const PATH_EXCEPTIONS: Readonly<Record<string, string>> = {
  'apps/lab/vite.config.ts': 'asks which version it builds, which no browser runs',
  'packages/hardcases/src/host-mutations.gpu.test.ts':
    'replaces modules inside of core, to show that hard cases fail without them',
  'packages/cli/bin/websplatter.js': 'builds itself where a clone has no build yet',
  'packages/cli/src/machine.ts':
    'names version and commit as the builds of apps do, and is bundled: no package that ships imports tools',
  'apps/viewer/vite.config.ts': "strips shaders as the packages' build does, which no browser runs",
  'apps/docs/src/build/examples.ts': 'shows the examples and their sources; apps export nothing',
  'apps/docs/src/build/kit.ts': "builds the examples' scenes beside what they import; apps export nothing",
  'e2e/wgpu/shaders.ts': "compiles every variant of core's shaders, which core does not export",
  'e2e/viewer-modes.test.ts': "draws the viewer's own effects in float64; apps export nothing",
  'e2e/examples.test.ts': "draws the examples' own scene and effect in float64; apps export nothing",
};
