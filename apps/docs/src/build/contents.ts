// Contents of the site, in order: the sidebar, and the repository's documents that are whole pages.

/**
 * Documents of the repository that are whole pages, by path. Links to a document lead to its page.
 */
export const REPOSITORY_PAGES: Readonly<Record<string, string>> = {
  'ARCHITECTURE.md': 'contribute/architecture.md',
  'CONTRIBUTING.md': 'contribute/contributing.md',
  'SECURITY.md': 'contribute/security.md',
  'apps/docs/README.md': 'contribute/site.md',
  'apps/lab/README.md': 'tools/lab.md',
  'apps/viewer/README.md': 'tools/viewer.md',
  'docs/accuracy.md': 'hood/accuracy.md',
  'docs/browsers.md': 'hood/browsers.md',
  'docs/decisions/001-tile-rasteriser.md': 'contribute/decisions/001-tile-rasteriser.md',
  'docs/decisions/002-radix-sort.md': 'contribute/decisions/002-radix-sort.md',
  'docs/decisions/003-settings-that-went.md': 'contribute/decisions/003-settings-that-went.md',
  'docs/decisions/004-codecs.md': 'contribute/decisions/004-codecs.md',
  'docs/decisions/005-file-server.md': 'contribute/decisions/005-file-server.md',
  'docs/decisions/006-no-found-palettes.md': 'contribute/decisions/006-no-found-palettes.md',
  'docs/decisions/007-larger-bins.md': 'contribute/decisions/007-larger-bins.md',
  'docs/decisions/008-compute-instead-of-render-passes.md':
    'contribute/decisions/008-compute-instead-of-render-passes.md',
  'docs/decisions/009-direct-dispatches.md': 'contribute/decisions/009-direct-dispatches.md',
  'docs/decisions/010-log-scales-by-chunk.md': 'contribute/decisions/010-log-scales-by-chunk.md',
  'docs/decisions/011-software-without-barriers.md': 'contribute/decisions/011-software-without-barriers.md',
  'docs/decisions/012-opacities-above-one.md': 'contribute/decisions/012-opacities-above-one.md',
  'docs/decisions/013-presets-after-tiles.md': 'contribute/decisions/013-presets-after-tiles.md',
  'docs/decisions/014-levels-around-edits.md': 'contribute/decisions/014-levels-around-edits.md',
  'docs/decisions/015-distance-of-near-chunks.md': 'contribute/decisions/015-distance-of-near-chunks.md',
  'docs/decisions/016-weights-of-merged-splats.md': 'contribute/decisions/016-weights-of-merged-splats.md',
  'docs/decisions/017-equal-shares-of-stream-budget.md':
    'contribute/decisions/017-equal-shares-of-stream-budget.md',
  'docs/decisions/018-edits-on-the-cpu.md': 'contribute/decisions/018-edits-on-the-cpu.md',
  'docs/decisions/019-bounds-of-morphs.md': 'contribute/decisions/019-bounds-of-morphs.md',
  'docs/decisions/020-wide-keys-in-integers.md': 'contribute/decisions/020-wide-keys-in-integers.md',
  'docs/decisions/021-two-workers.md': 'contribute/decisions/021-two-workers.md',
  'docs/decisions/022-prefetch-by-idle-requests.md': 'contribute/decisions/022-prefetch-by-idle-requests.md',
  'docs/decisions/023-rays-know-the-image.md': 'contribute/decisions/023-rays-know-the-image.md',
  'docs/dependencies.md': 'contribute/dependencies.md',
  'docs/detail.md': 'guides/level-of-detail.md',
  'docs/effects.md': 'guides/write-an-effect.md',
  'docs/faults.md': 'contribute/faults.md',
  'docs/formats.md': 'hood/formats.md',
  'docs/framing.md': 'hood/framing.md',
  'docs/glossary.md': 'contribute/glossary.md',
  'docs/hard-cases.md': 'hood/correctness.md',
  'docs/benchmarks.md': 'hood/benchmarks.md',
  'docs/bricks.md': 'hood/bricks.md',
  'docs/streamed-scenes.md': 'hood/streamed-scenes.md',
  'docs/releasing.md': 'contribute/releasing.md',
  'docs/tests.md': 'contribute/tests.md',
  'docs/three.md': 'contribute/three.md',
  'packages/cli/README.md': 'tools/cli.md',
  'packages/core/README.md': 'packages/core.md',
  'packages/core/src/clouds/README.md': 'contribute/clouds.md',
  'packages/core/src/frame/README.md': 'contribute/frame.md',
  'packages/core/src/gpu/README.md': 'contribute/gpu.md',
  'packages/core/src/gpu/effects/README.md': 'contribute/effects.md',
  'packages/core/src/io/README.md': 'contribute/io.md',
  'packages/core/src/views/README.md': 'contribute/views.md',
  'packages/react/README.md': 'packages/react.md',
  'packages/three/README.md': 'packages/three.md',
};

export interface Section {
  readonly text: string;
  readonly pages: readonly { readonly text: string; readonly page: string }[];
}

/** Sidebar contents, except examples, API and evidence, which are generated. */
export const SECTIONS: readonly Section[] = [
  {
    text: 'Learn',
    pages: [
      { text: 'Quick start', page: 'learn/quick-start.md' },
      { text: 'Get a scene', page: 'learn/get-a-scene.md' },
      { text: 'Camera and orientation', page: 'learn/camera.md' },
      { text: 'Which API do I need?', page: 'learn/which-api.md' },
      { text: 'Troubleshooting', page: 'learn/troubleshooting.md' },
    ],
  },
  {
    text: 'Guides',
    pages: [
      { text: 'Loading and progress', page: 'guides/loading.md' },
      { text: 'Streaming large scenes', page: 'guides/streaming.md' },
      { text: 'Level of detail', page: 'guides/level-of-detail.md' },
      { text: 'Effects', page: 'guides/effects.md' },
      { text: 'Write an effect', page: 'guides/write-an-effect.md' },
      { text: 'Depth and transparency', page: 'guides/depth.md' },
      { text: 'Events and picking', page: 'guides/events.md' },
      { text: 'Labels and measuring', page: 'guides/labels.md' },
      { text: 'Instances', page: 'guides/instances.md' },
      { text: 'Sequences', page: 'guides/sequences.md' },
      { text: 'Own data, edits and morphs', page: 'guides/own-data.md' },
      { text: 'Post-processing', page: 'guides/post-processing.md' },
      { text: 'Several cameras and XR', page: 'guides/xr.md' },
      { text: 'Saving and converting', page: 'guides/saving.md' },
      { text: 'Bounds and physics', page: 'guides/physics.md' },
      { text: 'drei', page: 'guides/drei.md' },
    ],
  },
  {
    text: 'Shipping',
    pages: [
      { text: 'Next.js, servers and posters', page: 'shipping/next.md' },
      { text: 'Bundlers and workers', page: 'shipping/bundlers.md' },
      { text: 'Hosting', page: 'shipping/hosting.md' },
      { text: 'Performance', page: 'shipping/performance.md' },
      { text: 'Errors and fallbacks', page: 'shipping/errors.md' },
    ],
  },
  {
    text: 'Packages',
    pages: [
      { text: '@websplatter/react', page: 'packages/react.md' },
      { text: '@websplatter/three', page: 'packages/three.md' },
      { text: '@websplatter/core', page: 'packages/core.md' },
    ],
  },
  {
    text: 'Under the hood',
    pages: [
      { text: 'How a frame is rendered', page: 'hood/frame.md' },
      { text: 'Correctness', page: 'hood/correctness.md' },
      { text: 'Accuracy presets', page: 'hood/accuracy.md' },
      { text: 'Accuracy on your device', page: 'hood/accuracy-here.md' },
      { text: 'Benchmarks', page: 'hood/benchmarks.md' },
      { text: 'File formats', page: 'hood/formats.md' },
      { text: 'Streamed scenes', page: 'hood/streamed-scenes.md' },
      { text: 'The .bricks format', page: 'hood/bricks.md' },
      { text: 'First cameras', page: 'hood/framing.md' },
      { text: 'Browsers', page: 'hood/browsers.md' },
    ],
  },
  {
    text: 'Tools',
    pages: [
      { text: 'Viewer', page: 'tools/viewer.md' },
      { text: 'Command line', page: 'tools/cli.md' },
      { text: 'Lab', page: 'tools/lab.md' },
    ],
  },
  {
    text: 'Contribute',
    pages: [
      { text: 'Contributing', page: 'contribute/contributing.md' },
      { text: 'Architecture', page: 'contribute/architecture.md' },
      { text: 'Tests', page: 'contribute/tests.md' },
      { text: 'Add a format', page: 'contribute/add-a-format.md' },
      { text: 'Debug a picture', page: 'contribute/debug-a-picture.md' },
      { text: 'Glossary', page: 'contribute/glossary.md' },
      { text: 'File reading', page: 'contribute/io.md' },
      { text: 'Device, shaders and stages', page: 'contribute/gpu.md' },
      { text: 'Effects and automatic features', page: 'contribute/effects.md' },
      { text: 'Clouds on the GPU', page: 'contribute/clouds.md' },
      { text: 'Inside a frame', page: 'contribute/frame.md' },
      { text: 'Views', page: 'contribute/views.md' },
      { text: 'Inside three.js and React', page: 'contribute/three.md' },
      { text: 'Failure modes', page: 'contribute/faults.md' },
      { text: 'This site', page: 'contribute/site.md' },
      { text: 'Dependencies', page: 'contribute/dependencies.md' },
      { text: 'Versions and releases', page: 'contribute/releasing.md' },
      { text: 'Security', page: 'contribute/security.md' },
      { text: 'Changelog', page: 'contribute/changelog.md' },
    ],
  },
  {
    text: 'Decisions',
    pages: [
      {
        text: '001 Threads of a tile find their splats by binary search',
        page: 'contribute/decisions/001-tile-rasteriser.md',
      },
      {
        text: '002 The sort takes as many bits per pass as keys need',
        page: 'contribute/decisions/002-radix-sort.md',
      },
      {
        text: '003 Settings that are never worth it are gone',
        page: 'contribute/decisions/003-settings-that-went.md',
      },
      {
        text: '004 Codecs of our own for zip, Zstandard and WebP',
        page: 'contribute/decisions/004-codecs.md',
      },
      { text: '005 Tests serve files by send', page: 'contribute/decisions/005-file-server.md' },
      {
        text: '006 The engine finds no palettes of harmonics',
        page: 'contribute/decisions/006-no-found-palettes.md',
      },
      {
        text: '007 Frames whose pairs do not fit have larger bins',
        page: 'contribute/decisions/007-larger-bins.md',
      },
      {
        text: '008 Compositing and upscaling are compute passes',
        page: 'contribute/decisions/008-compute-instead-of-render-passes.md',
      },
      { text: '009 Small dispatches are direct', page: 'contribute/decisions/009-direct-dispatches.md' },
      {
        text: '010 Packed log scales have a range per chunk',
        page: 'contribute/decisions/010-log-scales-by-chunk.md',
      },
      {
        text: '011 Software rasterisers get shaders without barriers',
        page: 'contribute/decisions/011-software-without-barriers.md',
      },
      {
        text: '012 Opacities above 1 become copies',
        page: 'contribute/decisions/012-opacities-above-one.md',
      },
      {
        text: '013 The presets kept their settings when tiles came',
        page: 'contribute/decisions/013-presets-after-tiles.md',
      },
      { text: '014 Cuts go around edited splats', page: 'contribute/decisions/014-levels-around-edits.md' },
      {
        text: '015 Chunks around the camera are as far as the near plane',
        page: 'contribute/decisions/015-distance-of-near-chunks.md',
      },
      {
        text: '016 Merged splats keep the weight of all their splats',
        page: 'contribute/decisions/016-weights-of-merged-splats.md',
      },
      {
        text: '017 Streamed scenes have equal shares of memory',
        page: 'contribute/decisions/017-equal-shares-of-stream-budget.md',
      },
      { text: '018 Edits are packed on the CPU', page: 'contribute/decisions/018-edits-on-the-cpu.md' },
      {
        text: '019 Morphs have bounds for every amount',
        page: 'contribute/decisions/019-bounds-of-morphs.md',
      },
      {
        text: '020 Float64 sort keys are computed in integers',
        page: 'contribute/decisions/020-wide-keys-in-integers.md',
      },
      { text: '021 PLY has a worker of its own', page: 'contribute/decisions/021-two-workers.md' },
      {
        text: '022 Prefetch takes requests that nothing else needs',
        page: 'contribute/decisions/022-prefetch-by-idle-requests.md',
      },
      {
        text: '023 Rays know the image that they belong to',
        page: 'contribute/decisions/023-rays-know-the-image.md',
      },
    ],
  },
];

const USER_SECTIONS = ['Learn', 'Guides', 'Shipping', 'Under the hood', 'Tools'];

/** Sidebar sections by a page's folder. Collapsible groups would nest buttons. */
export const SIDEBARS: Readonly<Record<string, readonly string[]>> = {
  '/learn/': USER_SECTIONS,
  '/guides/': USER_SECTIONS,
  '/shipping/': USER_SECTIONS,
  '/hood/': USER_SECTIONS,
  '/tools/': USER_SECTIONS,
  '/packages/': ['Packages'],
  '/examples/': ['Examples'],
  '/api/': ['API'],
  '/contribute/': ['Contribute', 'Decisions', 'Evidence'],
  '/evidence/': ['Contribute', 'Decisions', 'Evidence'],
};
