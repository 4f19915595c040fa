import { type CanvasProps, type ThreeElements, useLoader } from '@react-three/fiber';
import type {
  DrawnAccuracy,
  EffectEntry,
  EngineMemory,
  FrameRasterizer,
  SceneFiles,
  SplatFrame,
  Vec3,
} from '@websplatter/core';
import type { SplatInstances } from '@websplatter/three';
import type { Ref } from 'react';
import type { Box3, Layers, Plane, Sphere } from 'three';
import { WebGPURenderer, type WebGPURendererParameters } from 'three/webgpu';
import { expectTypeOf, it } from 'vitest';
import type { SplatInstancesProps } from './components.ts';
import {
  type SplatStream,
  useSplatAccuracy,
  useSplatEffects,
  useSplatMemory,
  useSplatStreams,
} from './hooks.ts';
import {
  type AccuracyRequest,
  adoptRenderer,
  createSplatRenderer,
  type Detail,
  type EffectProps,
  type EffectUse,
  type RevealAnimation,
  type SplatCloudObject,
  type SplatData,
  SplatLoader,
  type SplatsProps,
  useSplats,
} from './index.ts';
import { inPathOrder, type SplatSequenceState, useSplatSequence } from './sequence.ts';

// Checked by the compiler (`npm run typecheck`); no runner of tests opens this file.
it('types the props of a Canvas and of <Splats>', () => {
  expectTypeOf(createSplatRenderer).toExtend<NonNullable<CanvasProps['gl']>>();
  expectTypeOf((props: Parameters<typeof createSplatRenderer>[0]) =>
    createSplatRenderer({ ...props, accuracy: 'high' }),
  ).toExtend<NonNullable<CanvasProps['gl']>>();
  expectTypeOf((props: object) =>
    adoptRenderer(new WebGPURenderer(props as WebGPURendererParameters), { accuracy: 'high' }),
  ).toExtend<NonNullable<CanvasProps['gl']>>();
  expectTypeOf<SplatsProps['src']>().toEqualTypeOf<
    string | URL | Blob | ArrayBuffer | SceneFiles | SplatFrame | SplatData | null | undefined
  >();
  expectTypeOf<SplatsProps['ref']>().toEqualTypeOf<Ref<SplatCloudObject> | undefined>();
  expectTypeOf<[number, number, number]>().toExtend<SplatsProps['position']>();
  expectTypeOf<SplatsProps['accuracy']>().toEqualTypeOf<AccuracyRequest | null | undefined>();
  expectTypeOf<SplatsProps['detail']>().toEqualTypeOf<Detail | null | undefined>();
  expectTypeOf<SplatsProps['opacity']>().toEqualTypeOf<number | undefined>();
  expectTypeOf<SplatsProps['time']>().toEqualTypeOf<number | null | undefined>();
  expectTypeOf<SplatsProps['fade']>().toEqualTypeOf<number | undefined>();
  expectTypeOf<SplatsProps['fog']>().toEqualTypeOf<boolean | undefined>();
  expectTypeOf<SplatsProps['effects']>().toEqualTypeOf<readonly EffectUse[] | undefined>();
  expectTypeOf<RevealAnimation>().toExtend<SplatsProps['reveal']>();
  expectTypeOf<SplatsProps['onClick']>().not.toBeAny();
  // One by one: a union is no key as soon as one of its members is none.
  expectTypeOf<SplatsProps>().not.toHaveProperty('announceDrawn');
  expectTypeOf<SplatsProps>().not.toHaveProperty('data');
  expectTypeOf<SplatsProps>().not.toHaveProperty('effectsAt');
  expectTypeOf<SplatsProps>().not.toHaveProperty('geometry');
  expectTypeOf<SplatsProps>().not.toHaveProperty('hold');
  expectTypeOf<SplatsProps>().not.toHaveProperty('leave');
  expectTypeOf<SplatsProps>().not.toHaveProperty('tell');
  expectTypeOf<null>().toExtend<SplatsProps['dispose']>();
  expectTypeOf<() => null>().toExtend<SplatsProps['raycast']>();
  expectTypeOf<SplatsProps['frustumCulled']>().toEqualTypeOf<boolean | undefined>();
  expectTypeOf<SplatsProps['renderOrder']>().toEqualTypeOf<number | undefined>();
  expectTypeOf<number>().toExtend<SplatsProps['layers']>();
  expectTypeOf<Layers>().toExtend<SplatsProps['layers']>();
  expectTypeOf<SplatsProps['matrixWorldAutoUpdate']>().toEqualTypeOf<boolean | undefined>();
});

it('types the props of <SplatInstances>', () => {
  expectTypeOf<SplatInstancesProps['matrices']>().toEqualTypeOf<ArrayLike<number> | undefined>();
  expectTypeOf<['orange', [number, number, number]]>().toExtend<SplatInstancesProps['tints']>();
  expectTypeOf<Float32Array>().toExtend<SplatInstancesProps['opacities']>();
  expectTypeOf<SplatInstancesProps['ref']>().toEqualTypeOf<Ref<SplatCloudObject> | undefined>();
  expectTypeOf<SplatInstances | null>().toEqualTypeOf<SplatCloudObject['instances']>();
  expectTypeOf<SplatInstancesProps>().not.toHaveProperty('instances');
  expectTypeOf<SplatInstancesProps['detail']>().toEqualTypeOf<SplatsProps['detail']>();
  expectTypeOf<SplatInstances>().toExtend<SplatsProps['instances']>();
});

it('types every effect’s prop as a property of the object', () => {
  type Given = { [Name in keyof EffectProps]-?: NonNullable<EffectProps[Name]> };
  expectTypeOf<Given>().toExtend<Pick<SplatCloudObject, keyof EffectProps>>();
  expectTypeOf<[number, number, number]>().toExtend<SplatsProps['tint']>();
  const box = { shape: 'box', mode: 'keep', size: [1, 1, 1], rotation: [0, 0, 0, 1] } as const;
  expectTypeOf<[typeof box, Plane, Box3, Sphere]>().toExtend<SplatsProps['volumes']>();
  expectTypeOf<[{ shape: 'box'; size: Vec3 }]>().not.toExtend<SplatsProps['volumes']>();
});

it('takes part in shadows as meshes do', () => {
  expectTypeOf<SplatsProps['castShadow']>().toEqualTypeOf<boolean | undefined>();
  expectTypeOf<SplatsProps['receiveShadow']>().toEqualTypeOf<boolean | undefined>();
});

it('is lit by a share of the scene’s light', () => {
  expectTypeOf<SplatsProps['relight']>().toEqualTypeOf<number | undefined>();
});

it('refuses props that contradict each other or do nothing', () => {
  expectTypeOf<{ minPsnrDb: number; maxFrameMs: number }>().not.toExtend<SplatsProps['accuracy']>();
  expectTypeOf<{ minPsnrDb: number; preset: 'high' }>().not.toExtend<SplatsProps['accuracy']>();
  expectTypeOf<{ from: 'camera'; radius: number; durationMs: number }>().not.toExtend<
    SplatsProps['reveal']
  >();
  expectTypeOf<SplatsProps>().not.toHaveProperty('args');
  expectTypeOf<SplatsProps>().not.toHaveProperty('attach');
  expectTypeOf<SplatsProps>().not.toHaveProperty('customDepthMaterial');
  expectTypeOf<SplatsProps>().not.toHaveProperty('material');
  expectTypeOf<SplatsProps>().not.toHaveProperty('onAfterRender');
  expectTypeOf<SplatsProps>().not.toHaveProperty('onBeforeRender');
  expectTypeOf<SplatsProps>().not.toHaveProperty('static');
});

it('types useSplats without a source', () => {
  expectTypeOf(() => useSplats('garden.ply')).returns.toEqualTypeOf<SplatData>();
  expectTypeOf(() => useSplats(null)).returns.toEqualTypeOf<SplatData | null>();
});

/**
 * @fault three.js and React: a selector is passed to a hook of `@websplatter/react/hooks`
 * @consequence the result has the type that the selector returns
 */
it('types the selectors of hooks that follow an engine, and what they return', () => {
  const memory = () => useSplatMemory(({ totalBytes }) => totalBytes);
  expectTypeOf(memory).returns.toEqualTypeOf<number | null>();
  const memoryOutside = (renderer: WebGPURenderer) => useSplatMemory((found) => found.totalBytes, renderer);
  expectTypeOf(memoryOutside).returns.toEqualTypeOf<number | null>();
  expectTypeOf(() => useSplatMemory()).returns.toEqualTypeOf<EngineMemory | null>();
  expectTypeOf((renderer: WebGPURenderer) =>
    useSplatMemory(renderer),
  ).returns.toEqualTypeOf<EngineMemory | null>();

  const effects = () => useSplatEffects((found) => found.map(({ name }) => name));
  expectTypeOf(effects).returns.toEqualTypeOf<string[] | null>();
  expectTypeOf(() => useSplatEffects()).returns.toEqualTypeOf<readonly EffectEntry[] | null>();

  const rasterizer = () => useSplatAccuracy((found) => found.rasterizer);
  expectTypeOf(rasterizer).returns.toEqualTypeOf<FrameRasterizer | null>();
  expectTypeOf(() => useSplatAccuracy()).returns.toEqualTypeOf<DrawnAccuracy | null>();

  const missing = () => useSplatStreams((found) => found.map(({ missingBricks }) => missingBricks));
  expectTypeOf(missing).returns.toEqualTypeOf<number[] | null>();
  expectTypeOf(() => useSplatStreams()).returns.toEqualTypeOf<readonly SplatStream[] | null>();
});

it('types useLoader with a SplatLoader', () => {
  const load = () => useLoader(SplatLoader, 'garden.ply', (loader) => loader.setAccuracy('high'));
  expectTypeOf(load).returns.toEqualTypeOf<SplatData>();
  const loadAny = (address: string) => useLoader(SplatLoader, address);
  expectTypeOf(loadAny).returns.toEqualTypeOf<SplatData>();
  const loadAll = (addresses: string[]) => useLoader(SplatLoader, addresses);
  expectTypeOf(loadAll).returns.toEqualTypeOf<SplatData[]>();
  expectTypeOf<SplatLoader['loadAsync']>().toBeCallableWith(new Blob());
});

it('types <splatCloudObject> for applications that extend', () => {
  expectTypeOf<SplatData | null>().toExtend<ThreeElements['splatCloudObject']['data']>();
  expectTypeOf<ThreeElements['splatCloudObject']['opacity']>().toEqualTypeOf<number | undefined>();
});

it('types useSplatSequence', () => {
  expectTypeOf<SplatSequenceState['data']>().toEqualTypeOf<SplatData | null>();
  expectTypeOf(useSplatSequence).toBeCallableWith(inPathOrder([]), { budgetBytes: 1, loop: false });
  expectTypeOf(useSplatSequence).toBeCallableWith('dancer.frames');
  expectTypeOf<ReadableStream>().not.toExtend<Parameters<typeof useSplatSequence>[0]>();
  expectTypeOf<{ frame: number }>().toExtend<Parameters<SplatSequenceState['seek']>[0]>();
});
