import { type Choice, Choices } from '@websplatter/kit/choices';
import { IconButton, TextButton } from '@websplatter/kit/controls';
import { Icon } from '@websplatter/kit/icon';
import { toggleTheme } from '@websplatter/kit/theme';
import { useStore } from 'zustand';
import { openAnnotation, removeAnnotation } from '../annotate/annotations.ts';
import { editPicture } from '../engine/edit-picture.ts';
import type { PanelProps } from '../engine/viewer.ts';
import { annotationTitle } from '../state/annotating.ts';
import { type Background, FOV_DEGREES, type Look, type TravelName } from '../state/camera.ts';
import { COMMANDS, type RunCommand, TRAVEL_COMMANDS } from '../state/command-list.ts';
import { isUpsideDown, UP_CHOICES, upAxisOf } from '../state/up-axis.ts';
import { Dock } from '../ui/dock.tsx';
import { toggleFullscreen, useFullscreen } from '../ui/fullscreen.ts';
import { Slider } from '../ui/slider.tsx';
import { useGesture } from '../ui/use-gesture.ts';
import { setViewMode } from '../view-modes/set-view-mode.ts';
import { VIEW_MODES, viewModeOf } from '../view-modes/view-modes.ts';
import { SavedViewsForm } from './saved-views-form.tsx';

const PROJECTIONS: readonly Choice<boolean>[] = [
  [false, 'Perspective', 'perspective'],
  [true, 'Orthographic', 'orthographic'],
];
const BACKGROUNDS: readonly Choice<Background>[] = [
  ['theme', 'Theme'],
  ['#000000', 'Black', 'black'],
  ['#ffffff', 'White', 'white'],
];
const TITLES: Readonly<Record<TravelName, string>> = {
  fly: 'By W, A, S, D, Q, E and the mouse',
  walk: 'On the ground, by W, A, S, D and the mouse',
};
/** Initial value of a custom colour. */
const OWN_COLOR = '#808080';

/**
 * Viewing options that have no gesture in the image, by how often they are wanted: what a story
 * needs comes first, modes that explain the rendering last.
 */
export function ViewPanel({ store, viewer, run }: PanelProps & { run: RunCommand }) {
  return (
    <Dock store={store} name="view">
      <div className="dock-body">
        <SavedViewsForm store={store} viewer={viewer} />
        <AnnotationsForm store={store} viewer={viewer} onPlace={() => run('annotate')} />
        <SidesForm store={store} run={run} />
        <Actions store={store} viewer={viewer} run={run} />
        <BackgroundForm store={store} viewer={viewer} />
        <CameraForm store={store} viewer={viewer} />
        <UpForm store={store} viewer={viewer} />
        <ModeForm store={store} viewer={viewer} />
      </div>
    </Dock>
  );
}

function Actions({ store, viewer, run }: PanelProps & { run: RunCommand }) {
  const travelling = useStore(store, (state) => state.travelling?.by);
  const isFullscreen = useFullscreen();
  return (
    <fieldset className="view-field">
      <legend>Move and show</legend>
      <div className="view-actions">
        {TRAVEL_COMMANDS.map(({ name, label, key }) => (
          <TextButton
            key={name}
            aria-keyshortcuts={key.toUpperCase()}
            aria-pressed={travelling === name}
            title={`${TITLES[name]} (${key.toUpperCase()})`}
            testId={name}
            onClick={() => run(name)}
          >
            <Icon name={name} />
            {label}
          </TextButton>
        ))}
        <TextButton
          title="Orbit around what is in the middle of the picture"
          testId="focus-middle"
          onClick={() => void viewer.focusMiddle()}
        >
          <Icon name="focus" />
          Orbit around the middle
        </TextButton>
        <TextButton aria-keyshortcuts="T" title="Changes the theme (T)" testId="theme" onClick={toggleTheme}>
          <Icon name="theme" />
          Light or dark theme
        </TextButton>
        {document.fullscreenEnabled && (
          <TextButton aria-pressed={isFullscreen} testId="fullscreen" onClick={() => void toggleFullscreen()}>
            <Icon name="fullscreen" />
            {isFullscreen ? 'Leave full screen' : 'Full screen'}
          </TextButton>
        )}
      </div>
    </fieldset>
  );
}

function CameraForm({ store, viewer }: PanelProps) {
  const { fovDegrees, isOrthographic } = useStore(store, (state) => state.look);
  const isOwnCamera = useStore(store, (state) => state.isOwnCamera);
  const degrees = Math.round(fovDegrees);
  const setLook = (name: string, look: Partial<Look>, gesture?: object) =>
    editPicture({ store, viewer }, name, () => viewer.camera.setLook(look), gesture);
  return (
    <>
      <fieldset className="view-field" disabled={isOwnCamera}>
        <legend>Projection</legend>
        <Choices
          choices={PROJECTIONS}
          chosen={isOrthographic}
          testId=""
          onChoose={(isOrthographic) => setLook('projection', { isOrthographic })}
        />
      </fieldset>
      <div className="view-field">
        <Slider
          label="Field of view"
          min={FOV_DEGREES.min}
          max={FOV_DEGREES.max}
          value={degrees}
          shown={`${degrees}°`}
          aria-valuetext={`${degrees} degrees over the shorter side`}
          disabled={isOwnCamera || isOrthographic}
          testId="fov"
          onValue={(value, gesture) => setLook('field of view', { fovDegrees: value }, gesture)}
        />
        {isOwnCamera && <p>This case is shown by a camera of its own until the view is moved.</p>}
      </div>
    </>
  );
}

const SIDES = COMMANDS.filter(({ name }) => name === 'outside' || name === 'inside' || name === 'flip');

/** Alternatives to the first view that was found. */
function SidesForm({ store, run }: Pick<PanelProps, 'store'> & { run: RunCommand }) {
  const canFlip = useStore(store, (state) => state.scene?.canFlip ?? false);
  // A file that is upside down is shown upright: this alone does not count as turned by a person.
  const isTurned = useStore(store, (state) => isUpsideDown(state, state.firstUp));
  return (
    <fieldset className="view-field" disabled={!canFlip}>
      <legend>Look at the scene</legend>
      <div className="view-actions">
        {SIDES.map(({ name, label, key }) => (
          <TextButton
            key={name}
            aria-keyshortcuts={key.toUpperCase()}
            aria-pressed={name === 'flip' ? isTurned : undefined}
            title={`${label} (${key.toUpperCase()})`}
            testId={name}
            onClick={() => run(name)}
          >
            {label}
          </TextButton>
        ))}
      </div>
    </fieldset>
  );
}

function UpForm({ store, viewer }: PanelProps) {
  const axis = useStore(store, upAxisOf);
  const canFlip = useStore(store, (state) => state.scene?.canFlip ?? false);
  return (
    <fieldset className="view-field" disabled={!canFlip}>
      <legend>Which way is up</legend>
      <Choices
        choices={UP_CHOICES}
        chosen={axis}
        testId="up-"
        onChoose={(each) => editPicture({ store, viewer }, 'up axis', () => viewer.camera.setUpAxis(each))}
      />
      <p>Captures mostly use −y, maps z.</p>
    </fieldset>
  );
}

function BackgroundForm({ store, viewer }: PanelProps) {
  const background = useStore(store, (state) => state.look.background);
  const isOwn = BACKGROUNDS.every(([value]) => value !== background);
  const { gesture, begins } = useGesture();
  const choose = (next: Background, own: object | null = null) =>
    editPicture({ store, viewer }, 'background', () => viewer.camera.setLook({ background: next }), own);
  return (
    <fieldset className="view-field">
      <legend>Background</legend>
      <div className="view-background">
        <Choices
          choices={BACKGROUNDS}
          chosen={background}
          testId="background-"
          onChoose={(each) => choose(each)}
        />
        <label className="view-color" data-chosen={isOwn || undefined}>
          Own
          <input
            {...begins}
            type="color"
            value={background === 'theme' ? OWN_COLOR : background}
            data-testid="background-own"
            onChange={({ target }) => choose(target.value as `#${string}`, gesture.current)}
          />
        </label>
      </div>
    </fieldset>
  );
}

/** Choice of the view mode. */
function ModeForm({ store, viewer }: PanelProps) {
  const viewMode = useStore(store, (state) => state.viewMode);
  return (
    <fieldset className="view-field">
      <legend>
        View mode <kbd>M</kbd>
      </legend>
      <Choices
        isChips
        choices={VIEW_MODES.map(({ name, label }) => [name, label])}
        chosen={viewMode}
        testId="mode-"
        titleOf={(name) => viewModeOf(name).about}
        onChoose={(name) => setViewMode({ store, viewer }, name)}
      />
    </fieldset>
  );
}

function AnnotationsForm({ store, viewer, onPlace }: PanelProps & { onPlace: () => void }) {
  const list = useStore(store, (state) => state.annotating.list);
  const hasScene = useStore(store, (state) => state.scene !== null);
  return (
    <fieldset className="view-field">
      <legend>Annotations</legend>
      {list.length > 0 && (
        <ol className="annotation-list" data-testid="annotations">
          {list.map((annotation, i) => (
            // biome-ignore lint/suspicious/noArrayIndexKey: titles may repeat.
            <li key={i} className="spread">
              <TextButton look="plain" onClick={() => openAnnotation({ store, viewer }, i)}>
                <b>{i + 1}</b>
                <span>{annotationTitle(annotation, i)}</span>
              </TextButton>
              <IconButton
                icon="close"
                label={`Remove annotation ${i + 1}`}
                onClick={() => removeAnnotation(store, i)}
              />
            </li>
          ))}
        </ol>
      )}
      <div className="view-actions">
        <TextButton disabled={!hasScene} aria-keyshortcuts="P" testId="annotate" onClick={onPlace}>
          <Icon name="annotate" />
          Annotate a place
        </TextButton>
      </div>
      <p>Notes pinned to the scene. Click a spot to place one.</p>
    </fieldset>
  );
}
