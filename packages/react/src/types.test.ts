import { type CanvasProps, type ThreeElements, useLoader } from '@react-three/fiber';
import type { SceneFiles } from '@websplatter/core';
import type { Ref } from 'react';
import { expectTypeOf, it } from 'vitest';
import {
  type AccuracyRequest,
  createSplatRenderer,
  type EffectUse,
  type RevealAnimation,
  type SplatData,
  SplatLoader,
  type SplatsObject,
  type SplatsProps,
} from './index.ts';

// Checked by the compiler; at run time these do nothing.
it('types the props of a Canvas and of <Splats>', () => {
  expectTypeOf(createSplatRenderer).toExtend<NonNullable<CanvasProps['gl']>>();
  expectTypeOf((props: Parameters<typeof createSplatRenderer>[0]) =>
    createSplatRenderer({ ...props, accuracy: 'high' }),
  ).toExtend<NonNullable<CanvasProps['gl']>>();
  expectTypeOf<SplatsProps['src']>().toEqualTypeOf<
    string | URL | Blob | ArrayBuffer | SceneFiles | SplatData
  >();
  expectTypeOf<SplatsProps['ref']>().toEqualTypeOf<Ref<SplatsObject> | undefined>();
  expectTypeOf<[number, number, number]>().toExtend<SplatsProps['position']>();
  expectTypeOf<SplatsProps['accuracy']>().toEqualTypeOf<AccuracyRequest | null | undefined>();
  expectTypeOf<SplatsProps['opacity']>().toEqualTypeOf<number | undefined>();
  expectTypeOf<SplatsProps['fog']>().toEqualTypeOf<boolean | undefined>();
  expectTypeOf<SplatsProps['effects']>().toEqualTypeOf<readonly EffectUse[] | undefined>();
  expectTypeOf<RevealAnimation>().toExtend<SplatsProps['reveal']>();
  expectTypeOf<SplatsProps['onClick']>().not.toBeAny();
  expectTypeOf<SplatsProps>().not.toHaveProperty('data');
});

it('types useLoader with a SplatLoader', () => {
  const load = () => useLoader(SplatLoader, 'garden.ply', (loader) => loader.setAccuracy('high'));
  expectTypeOf(load).returns.toEqualTypeOf<SplatData>();
  expectTypeOf<SplatLoader['loadAsync']>().toBeCallableWith(new Blob());
});

it('types <splatCloudObject> for applications that extend', () => {
  expectTypeOf<SplatData | null>().toExtend<ThreeElements['splatCloudObject']['data']>();
  expectTypeOf<ThreeElements['splatCloudObject']['opacity']>().toEqualTypeOf<number | undefined>();
});
