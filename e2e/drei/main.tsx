// A page of splats beside one component of drei, or beside labels and a mesh that splats hide.
import { type RootState, useFrame } from '@react-three/fiber';
import { SplatCanvas, type SplatCloudObject, Splats } from '@websplatter/react';
import { type ReactNode, Suspense, useRef } from 'react';
import { createRoot } from 'react-dom/client';
import { FittedCanvas, type FittedScene } from './bounds.tsx';
import { type StillLife, StillLifeScene } from './labels.tsx';
import { TRIALS, type Trial } from './trials.tsx';

const page = {
  trials: Object.entries(TRIALS).map(([name, { expects, coversSplats = false }]) => ({
    name,
    expects,
    coversSplats,
  })),
  /** The newest Canvas. */
  canvas: null as RootState | null,
  splats: null as SplatCloudObject | null,
  /** Frames of the newest Canvas since its content was loaded. */
  frames: 0,
  /** Errors thrown outside of every `try`, in rendering and in frames. */
  thrown: null as string | null,
  /** Shows a trial by name, `''` for splats alone. */
  show: (name: string) => {
    page.canvas = null;
    page.frames = 0;
    page.thrown = null;
    root.render(<TrialCanvas key={name} {...TRIALS[name]} />);
  },
  /** Objects that clicks have hit. */
  clicked: [] as string[],
  showStillLife: (shown: StillLife) => root.render(<StillLifeCanvas {...shown} />),
  /** Frames since `<SplatBounds>` fitted the camera for good; null before. */
  framesSinceFit: null as number | null,
  /** Shows clouds that `<SplatBounds>` fits the camera to. */
  showFitted: (shown: FittedScene) => {
    page.canvas = page.framesSinceFit = null;
    root.render(
      <FittedCanvas
        key={JSON.stringify(shown)}
        {...shown}
        onCreated={(state) => {
          page.canvas = state;
        }}
        onFit={(bounds) => {
          if (bounds.framing()) page.framesSinceFit = 0;
        }}
      >
        <Frames />
      </FittedCanvas>,
    );
  },
  /** Whether a trial's `holds` is true. */
  holds: (name: string) => page.canvas !== null && TRIALS[name].holds?.(page.canvas) === true,
};

declare global {
  interface Window {
    trialPage: typeof page;
  }
}

function TrialCanvas({ element: Element }: Partial<Trial>): ReactNode {
  const splats = useRef<SplatCloudObject>(null);
  return (
    <SplatCanvas
      flat
      shadows="percentage"
      dpr={1}
      camera={{ position: [0, 0, 5], fov: 50 }}
      onCreated={(state) => {
        page.canvas = state;
      }}
    >
      <color attach="background" args={['#202020']} />
      <ambientLight />
      <directionalLight position={[2, 5, 4]} castShadow />
      <Suspense>
        <Splats
          ref={(object) => {
            page.splats = splats.current = object;
          }}
          src="ball.ply"
          position-x={-1.5}
        />
        {Element && <Element splats={splats} />}
        <Frames />
      </Suspense>
    </SplatCanvas>
  );
}

function StillLifeCanvas(shown: StillLife): ReactNode {
  return (
    <SplatCanvas
      flat
      shadows="percentage"
      dpr={1}
      camera={{ position: [0.12, 0.45, 1.44], fov: 50, near: 0.05 }}
      onCreated={(state) => {
        page.canvas = state;
      }}
    >
      <Suspense>
        <StillLifeScene
          {...shown}
          onSplats={(splats) => {
            page.splats = splats;
          }}
          onClick={(what) => page.clicked.push(what)}
        />
        <Frames />
      </Suspense>
    </SplatCanvas>
  );
}

function Frames(): ReactNode {
  useFrame(() => {
    page.frames++;
    if (page.framesSinceFit !== null) page.framesSinceFit++;
  });
  return null;
}

window.addEventListener('error', ({ message }) => {
  page.thrown ??= message;
});
window.trialPage = page;
const root = createRoot(document.getElementById('root')!);
