// A page that shows a test's Canvases, and logs their events.
import { Canvas, type CanvasProps, type RootState, useLoader, useThree } from '@react-three/fiber';
import type { EngineOptions } from '@websplatter/core';
import { defineEffect, type EffectUse } from '@websplatter/core/effects';
import {
  type AccuracyRequest,
  createSplatRenderer,
  type Detail,
  type FrameStatistics,
  type RevealAnimation,
  SplatCanvas,
  SplatCloudObject,
  SplatLoader,
  Splats,
  SplatsErrorBoundary,
  type SplatsProps,
  SplatsStreamError,
  splatEngineOf,
  useSplats,
} from '@websplatter/react';
import {
  type Measurement,
  SplatAnnotation,
  SplatBounds,
  SplatMeasure,
  SplatStats,
} from '@websplatter/react/components';
import { SplatGltfPlugin } from '@websplatter/react/gltf';
import {
  type SplatDevice,
  type SplatStream,
  type StageTimingsSource,
  useSplatAccuracy,
  useSplatDevice,
  useSplatEffects,
  useSplatMemory,
  useSplatStreams,
  useStageTimings,
} from '@websplatter/react/hooks';
import { useSplatSequence } from '@websplatter/react/sequence';
import { type ReactNode, StrictMode, Suspense, useEffect, useMemo, useRef, useState } from 'react';
import { createRoot } from 'react-dom/client';
import { DefaultLoadingManager } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { WebGPURenderer, type WebGPURendererParameters } from 'three/webgpu';
import { drawnByEngine, type EngineScene } from './drawn-by-engine.ts';
import { countResources } from './resources.ts';

export interface SplatsDescription {
  readonly id: string;
  readonly src: string;
  readonly position?: readonly [number, number, number];
  readonly opacity?: number;
  readonly castShadow?: boolean;
  readonly receiveShadow?: boolean;
  readonly relight?: number;
  /** WGSL of an effect of its own, whose hook `ownColor` changes colours. */
  readonly ownWgsl?: string;
  readonly reveal?: RevealAnimation;
  readonly tint?: string;
  readonly accuracy?: AccuracyRequest;
  readonly detail?: Detail;
  readonly visible?: boolean;
  /** Hook that reads the splats, which are passed to `<Splats>`; default: `<Splats>` reads them. */
  readonly handedOnBy?: 'useSplats' | 'useLoader';
  /** Logs pointer events. */
  readonly hasEvents?: boolean;
  /** Logs errors by `onError`. */
  readonly hasErrors?: boolean;
  /** Logs `onComplete`. */
  readonly hasComplete?: boolean;
  /** Budget of a streamed scene. */
  readonly budgetBytes?: number;
}

export interface LabelDescription {
  readonly id: string;
  readonly position: readonly [number, number, number];
  /** World units. */
  readonly tolerance?: number;
}

export interface CanvasDescription {
  /** React key: another id is another Canvas. */
  readonly id: string;
  /**
   * `splats`: SplatCanvas; `bare`: Canvas with createSplatRenderer; `foreign`: with a WebGPURenderer
   * of its own; `webgl`: Canvas by default.
   */
  readonly kind: 'splats' | 'bare' | 'foreign' | 'webgl';
  readonly frameloop?: 'always' | 'demand';
  readonly background?: string;
  /** For kind `splats` only. */
  readonly accuracy?: AccuracyRequest;
  /** For kind `splats` only. */
  readonly detail?: Detail;
  /** For kind `splats` only. */
  readonly antialias?: boolean;
  /** For kind `splats` only. */
  readonly streamBudgetBytes?: number;
  /** Physical pixels per CSS pixel, default 1. */
  readonly dpr?: number;
  /** Not `flat`: tone-mapped. */
  readonly isToneMapped?: boolean;
  readonly splats: readonly SplatsDescription[];
  /** URLs of the frames of a sequence, which keeps two frames in memory. */
  readonly sequence?: readonly string[];
  /** Default true. */
  readonly hasSuspense?: boolean;
  /** Position of `<SplatStats>` in the tree; `outside` is for kind `bare` only. */
  readonly timings?: 'inside' | 'outside';
  /** Annotations: buttons labelled with their ids. */
  readonly labels?: readonly LabelDescription[];
  /** Middle of an opaque plane of 2 by 2 units that faces +z. */
  readonly wall?: readonly [number, number, number];
  /** Lights a floor at y = −1 from above: three draws the shadow map in each frame, or keeps it. */
  readonly shadowMap?: 'drawn' | 'kept';
  /** Measures in centimetres. */
  readonly hasMeasure?: boolean;
  /** Calls `useSplatStreams`, and keeps its result in `page.streams`. */
  readonly hasStreams?: boolean;
  /** Fits the camera to the splats, with the margin 1; `each`: after every load. */
  readonly isFitted?: boolean | 'each';
  /** Turns the camera by drags. */
  readonly hasControls?: boolean;
  /** A glTF in a `<primitive>`, whose cloud is kept in `page.objects` as `gltf`. */
  readonly gltf?: string;
  /** Calls the hooks that take a renderer outside of the Canvas, and keeps results in `page`. */
  readonly hasOutsideHooks?: boolean;
}

const page = {
  /** Events in order: the id of their subject, and their name. */
  log: [] as string[],
  /** State of the newest Canvas of each id. */
  canvases: new Map<string, RootState>(),
  objects: new Map<string, SplatCloudObject>(),
  statistics: [] as FrameStatistics[],
  measurements: [] as Measurement[],
  /** Last result of useStageTimings. */
  timings: null as StageTimingsSource | null,
  /** Last result of useSplatStreams. */
  streams: null as readonly SplatStream[] | null,
  /** Results of useSplatMemory outside of the Canvas: the bytes of all clouds. */
  outsideBytes: [] as (number | null)[],
  /** Results of useSplatDevice, outside of the Canvases. */
  devices: [] as SplatDevice['status'][],
  /** The newest error of a streamed scene. */
  streamError: null as SplatsStreamError | null,
  /** Renders of a component that uses `useStageTimings` only. */
  timingRenders: 0,
  /** Effects that StrictMode has run. */
  effects: 0,
  countResources,
  show: (canvases: readonly CanvasDescription[]) => root.render(<Page canvases={canvases} />),
  engine: (id: string) => splatEngineOf(page.canvases.get(id)!.gl),
  drawnByEngine: (id: string, scenes: readonly EngineScene[], options: EngineOptions) =>
    drawnByEngine(page.canvases.get(id)!, scenes, { ...options, device: page.engine(id).device }),
};

declare global {
  interface Window {
    page: typeof page;
  }
}

function note(id: string, what: string): void {
  page.log.push(`${id} ${what}`);
}

function fileName(url: string): string {
  return url.replace(/^.*\//, '');
}

function Page({ canvases }: { canvases: readonly CanvasDescription[] }): ReactNode {
  return (
    <StrictMode>
      <Device />
      {canvases.map((canvas) => (
        <div key={canvas.id} className="canvas" data-testid={canvas.id}>
          <SplatsErrorBoundary
            fallback={(error) => noted(canvas.id, `fallback ${error.name}: ${error.message}`)}
          >
            <OneCanvas {...canvas} />
          </SplatsErrorBoundary>
        </div>
      ))}
    </StrictMode>
  );
}

function noted(id: string, what: string): ReactNode {
  note(id, what);
  return null;
}

const RENDERERS: Record<'bare' | 'foreign' | 'webgl', CanvasProps['gl']> = {
  bare: createSplatRenderer,
  foreign: async (props) => {
    const renderer = new WebGPURenderer(props as WebGPURendererParameters);
    await renderer.init();
    return renderer;
  },
  webgl: undefined,
};

function OneCanvas(description: CanvasDescription): ReactNode {
  const {
    id,
    kind,
    isToneMapped,
    background,
    splats,
    timings,
    labels = [],
    wall,
    shadowMap,
    hasMeasure,
    hasStreams,
    isFitted,
    hasControls,
    gltf,
    hasOutsideHooks,
    frameloop,
    accuracy,
    detail,
    dpr = 1,
    sequence,
    hasSuspense = true,
    antialias,
    streamBudgetBytes,
  } = description;
  const [renderer, setRenderer] = useState<object | null>(null);
  const canvasProps = {
    flat: !isToneMapped,
    // Canvas asks for another kind of shadow map by default, which three warns to have removed.
    shadows: 'percentage' as const,
    dpr,
    frameloop,
    camera: { position: [1.5, 1, 5], fov: 50, near: 0.1, far: 100 } as const,
    onCreated: (state: RootState) => {
      page.canvases.set(id, state);
      setRenderer(state.gl);
      note(id, 'created');
    },
    onPointerMissed: () => note(id, 'missed'),
  };
  const shown = splats.map((each) => {
    const Shown = each.handedOnBy ? HANDED_ON[each.handedOnBy] : OneSplats;
    return <Shown key={each.id} {...each} />;
  });
  if (sequence) shown.push(<Sequence key="sequence" addresses={sequence} />);
  const clouds = isFitted ? (
    <SplatBounds
      margin={1}
      fit={isFitted === 'each' ? 'each' : 'once'}
      onChange={(bounds) => note(id, `fits ${bounds.box().isEmpty() ? 'nothing' : 'splats'}`)}
    >
      {shown}
    </SplatBounds>
  ) : (
    shown
  );
  const children = (
    <>
      {background && <color attach="background" args={[background]} />}
      {hasSuspense ? <Suspense fallback={<Waiting id={id} />}>{clouds}</Suspense> : clouds}
      {labels.map(({ id: label, position, tolerance }) => (
        <SplatAnnotation
          key={label}
          position={[...position]}
          tolerance={tolerance}
          onOcclude={(isHidden) => note(label, isHidden ? 'hidden' : 'free')}
        >
          <button type="button" onClick={() => note(label, 'click')}>
            {label}
          </button>
        </SplatAnnotation>
      ))}
      {hasMeasure && (
        <SplatMeasure
          unit={{ name: 'cm', perWorldUnit: 100, digits: 1 }}
          onMeasure={(measurement) => page.measurements.push(measurement)}
        />
      )}
      {wall && (
        <mesh position={[...wall]}>
          <planeGeometry args={[2, 2]} />
          <meshBasicMaterial color="gray" />
        </mesh>
      )}
      {shadowMap && (
        <>
          <directionalLight
            castShadow
            intensity={3}
            position={[0, 4, 0]}
            shadow-autoUpdate={shadowMap === 'drawn'}
          />
          <mesh receiveShadow position-y={-1} rotation-x={-Math.PI / 2}>
            <planeGeometry args={[6, 6]} />
            <meshLambertMaterial />
          </mesh>
        </>
      )}
      {hasControls && <Controls />}
      {gltf && <Gltf url={gltf} />}
      {timings && <Timings />}
      {hasStreams && <Streams />}
      {timings === 'inside' && <SplatStats corner="bottom-right" />}
    </>
  );
  if (kind === 'splats') {
    return (
      <>
        {hasOutsideHooks && <Outside renderer={renderer} />}
        <SplatCanvas
          {...canvasProps}
          accuracy={accuracy}
          detail={detail}
          gl={{ ...(antialias !== undefined && { antialias }), streamBudgetBytes }}
        >
          {children}
        </SplatCanvas>
      </>
    );
  }
  return (
    <>
      <Canvas {...canvasProps} gl={RENDERERS[kind]}>
        {children}
      </Canvas>
      {timings === 'outside' && <SplatStats renderer={renderer} />}
    </>
  );
}

function Waiting({ id }: { id: string }): ReactNode {
  useEffect(() => {
    note(id, 'suspended');
    return () => note(id, 'resumed');
  }, [id]);
  return null;
}

const HANDED_ON = {
  useSplats: (description: SplatsDescription) => (
    <OneSplats {...description} src={useSplats(description.src)} />
  ),
  useLoader: (description: SplatsDescription) => {
    const renderer = useThree((state) => state.gl);
    const forRenderer = (loader: SplatLoader) => void loader.detectSupport(renderer);
    return <OneSplats {...description} src={useLoader(SplatLoader, description.src, forRenderer)} />;
  },
};

function OneSplats({
  id,
  hasEvents,
  hasErrors,
  hasComplete,
  position,
  ownWgsl,
  handedOnBy: _,
  ...props
}: Omit<SplatsDescription, 'src'> & { src: SplatsProps['src'] }): ReactNode {
  const object = useRef<SplatCloudObject>(null);
  useEffect(() => {
    page.effects++;
    page.objects.set(id, object.current!);
    return () => void page.objects.delete(id);
  }, [id]);
  const effects = useMemo(() => (ownWgsl ? [ownEffect(ownWgsl)] : undefined), [ownWgsl]);
  const events = {
    onClick: () => note(id, 'click'),
    onPointerOver: () => note(id, 'over'),
    onPointerOut: () => note(id, 'out'),
    onPointerMissed: () => note(id, 'missed'),
  };
  return (
    <Splats
      ref={object}
      {...props}
      effects={effects}
      position={position && [...position]}
      onLoad={(splats) => note(id, `load ${fileName(splats.name)}`)}
      onFirstFrame={() => note(id, 'firstframe')}
      onDeviceLost={() => note(id, 'devicelost')}
      onComplete={hasComplete ? () => note(id, 'complete') : undefined}
      onError={
        hasErrors
          ? (error) => {
              note(id, `error ${(error as Error).name}`);
              if (error instanceof SplatsStreamError) page.streamError = error;
            }
          : undefined
      }
      {...(hasEvents ? events : {})}
    />
  );
}

function ownEffect(wgsl: string): EffectUse {
  const definition = { name: 'own-color', label: 'Own', about: 'Changes colours.', wgsl };
  return defineEffect({ ...definition, hooks: { color: 'ownColor' }, calledFor: () => 'a test asks' })();
}

function Sequence({ addresses }: { addresses: readonly string[] }): ReactNode {
  const { data } = useSplatSequence(addresses, { framesPerS: 20, maxHeldFrames: 2 });
  return <OneSplats id="sequence" src={data ?? ''} />;
}

function Device(): ReactNode {
  const { status } = useSplatDevice();
  useEffect(() => void page.devices.push(status), [status]);
  return null;
}

function Controls(): ReactNode {
  const { camera, gl, invalidate, set } = useThree();
  useEffect(() => {
    const controls = new OrbitControls(camera, gl.domElement);
    controls.addEventListener('change', () => invalidate());
    set({ controls });
    return () => controls.dispose();
  }, [camera, gl, invalidate, set]);
  return null;
}

function Gltf({ url }: { url: string }): ReactNode {
  const { scene } = useLoader(GLTFLoader, url, (loader) => {
    loader.register((parser) => new SplatGltfPlugin(parser));
  });
  useEffect(() => {
    scene.traverse((object) => {
      if (object instanceof SplatCloudObject) page.objects.set('gltf', object);
    });
  }, [scene]);
  return <primitive object={scene} />;
}

function Outside({ renderer }: { renderer: object | null }): ReactNode {
  const bytes = useSplatMemory(({ totalBytes }) => totalBytes, renderer);
  useSplatEffects(renderer);
  useSplatAccuracy(renderer ?? undefined);
  useSplatStreams((streams) => streams.length, renderer ?? undefined);
  useStageTimings(undefined, renderer);
  useEffect(() => void page.outsideBytes.push(bytes), [bytes]);
  return <SplatStats renderer={renderer ?? undefined} />;
}

function Streams(): ReactNode {
  page.streams = useSplatStreams();
  return null;
}

function Timings(): ReactNode {
  page.timingRenders++;
  page.timings = useStageTimings((statistics) => page.statistics.push(statistics));
  return null;
}

DefaultLoadingManager.onStart = (url) => note('manager', `start ${fileName(url)}`);
DefaultLoadingManager.onLoad = () => note('manager', 'idle');

window.page = page;
const root = createRoot(document.getElementById('root')!);
