import { type Choice, Choices } from '@websplatter/kit/choices';
import { TextButton } from '@websplatter/kit/controls';
import { formatSplats } from '@websplatter/kit/format';
import { useEffect, useState } from 'react';
import { useStore } from 'zustand';
import { leftSplats } from '../state/left-splats.ts';
import { countOf, SELECT_TOOLS, type SelectMode, type SelectTool } from '../state/selecting.ts';
import { NumberField } from '../ui/number-field.tsx';
import { Slider } from '../ui/slider.tsx';
import { Action, ofLeft, StepActions } from './actions.tsx';
import { FloatersForm } from './floaters-form.tsx';
import type { InspectProps } from './inspection.ts';

const TOOLS: readonly Choice<SelectTool | null>[] = [
  ...SELECT_TOOLS.map(({ name, label }) => [name, label] as const),
  [null, 'Orbit', 'turn'],
];
const MODES: readonly Choice<SelectMode>[] = [
  ['replace', 'New'],
  ['add', 'Add'],
  ['subtract', 'Subtract'],
];
const HINTS: Readonly<Record<SelectTool, string>> = {
  rectangle: 'Drag over the picture to select the splats whose centres are in the rectangle, however deep.',
  brush: 'Paint over the picture to select the splats whose centres the brush passes, however deep.',
  polygon:
    'Click corners around centres of splats, however deep. Enter, or a click on the first corner, closes the polygon; Backspace takes the last corner back; Escape cancels.',
  sphere:
    'Drag from a splat to the edge of a sphere around it, or click one to keep the radius. The splats whose centres are in the sphere are selected.',
  color: 'Click a splat to select all splats with about its base colour, wherever they are. A drag orbits.',
};
const COMMON_HINT = 'Shift adds, Alt subtracts. Two fingers, the right button and keys move the camera.';
const BRUSH_PX = { least: 4, most: 120 } as const;

/** Selects splats in the picture, removes them, and saves the selected or the other ones. */
export function SelectTab({ store, inspection }: InspectProps) {
  const { selected, removed, tool, mode } = useStore(store, (state) => state.inspecting.selecting);
  const marked = useStore(store, (state) => state.inspecting.marked);
  const left = useStore(store, leftSplats);
  const canSave = useStore(store, (state) => state.scene?.canSave ?? false);
  const { selecting } = inspection;
  const save = (savesSelection: boolean) => {
    selecting.choose({ savesSelection });
    store.setState({ dock: 'save', saveTab: 'file' });
  };
  const [selectedCount, removedCount] = [countOf(selected), countOf(removed)];
  return (
    <div className="inspect-sections">
      <Choices
        label="Pointing at the picture"
        choices={TOOLS}
        chosen={tool}
        testId="select-"
        isChips
        titleOf={(each) => SELECT_TOOLS.find(({ name }) => name === each)?.key}
        onChoose={(each) => selecting.choose({ tool: each, dragged: null })}
      />
      <p>{tool ? `${HINTS[tool]} ${COMMON_HINT}` : 'A drag orbits the scene.'}</p>
      {tool === 'brush' && <BrushSize store={store} inspection={inspection} />}
      {tool === 'sphere' && <SphereRadius store={store} inspection={inspection} />}
      {tool === 'color' && <Tolerance store={store} inspection={inspection} />}
      <Choices
        label="How a new selection joins the old one"
        choices={MODES}
        chosen={mode}
        testId="select-mode-"
        onChoose={(each) => selecting.choose({ mode: each })}
      />
      <div className="inspect-actions">
        <Action
          testId="select-seen"
          title="All whose centres are within the picture"
          onClick={() => void selecting.selectSeen()}
        >
          In view
        </Action>
        <Action testId="select-all" onClick={() => void selecting.select({ kind: 'all' })}>
          All
        </Action>
        <Action testId="select-none" isOff={selected.size === 0} onClick={() => selecting.clear()}>
          None
        </Action>
        <Action testId="select-invert" onClick={() => void selecting.invert()}>
          Invert
        </Action>
        {marked && (
          <Action testId="select-marked" onClick={() => void selecting.select({ kind: 'bin', marked })}>
            The histogram’s bar
          </Action>
        )}
      </div>
      <FloatersForm store={store} inspection={inspection} />
      <p className="select-count" role="status" data-testid="select-count">
        {`${ofLeft(selectedCount, left)} are selected.`}
        {selectedCount > 0 && <HiddenPart store={store} inspection={inspection} />}
        {removedCount > 0 && ` ${formatSplats(removedCount)} removed.`}
      </p>
      <div className="inspect-actions">
        <Action
          testId="select-remove"
          title="Remove (Delete)"
          isOff={selected.size === 0}
          onClick={() => selecting.remove()}
        >
          Remove
        </Action>
        <StepActions store={store} />
        {removed.size > 0 && (
          <Action testId="select-restore" onClick={() => selecting.restore()}>
            Bring all back
          </Action>
        )}
      </div>
      {canSave && (
        <div className="inspect-actions">
          <Split store={store} inspection={inspection} isOff={selected.size === 0} />
          <Action testId="select-save" isOff={selected.size === 0} onClick={() => save(true)}>
            Save the selection
          </Action>
          <Action testId="select-save-left" isOff={removed.size === 0} onClick={() => save(false)}>
            Save the rest as a file
          </Action>
        </div>
      )}
    </div>
  );
}

/** How many of the selected splats others hide: nobody sees these in the picture, and they are removed, too. */
function HiddenPart({ store, inspection: { selecting } }: InspectProps) {
  const selected = useStore(store, (state) => state.inspecting.selecting.selected);
  const restedFrames = useStore(store, (state) => state.restedFrames);
  const [percent, setPercent] = useState(0);
  // biome-ignore lint/correctness/useExhaustiveDependencies: another view hides others.
  useEffect(() => {
    let isCurrent = true;
    void selecting.hiddenPart().then((part) => {
      if (isCurrent) setPercent(Math.round(100 * (part ?? 0)));
    });
    return () => {
      isCurrent = false;
    };
  }, [selecting, selected, restedFrames]);
  return percent > 0 && ` About ${percent} % of them lie behind others here.`;
}

/** Makes a file of the selection, which then has the handles and fields of files. */
function Split({ inspection, isOff }: InspectProps & { readonly isOff: boolean }) {
  const [isBusy, setBusy] = useState(false);
  const split = async () => {
    setBusy(true);
    await inspection.splitSelection();
    setBusy(false);
  };
  return (
    <Action
      testId="select-split"
      title="Makes the selection a file of its own, to be moved, turned and scaled"
      isOff={isOff || isBusy}
      onClick={() => void split()}
    >
      {isBusy ? 'Taking the selection out…' : 'Move, turn or scale'}
    </Action>
  );
}

function BrushSize({ store, inspection }: InspectProps) {
  const radius = useStore(store, (state) => state.inspecting.selecting.brushRadius);
  return (
    <Slider
      label="Brush"
      min={BRUSH_PX.least}
      max={BRUSH_PX.most}
      value={2 * radius}
      shown={`${2 * radius} px`}
      aria-valuetext={`${2 * radius} pixels wide`}
      testId="select-brush-size"
      onValue={(widthPx) => inspection.selecting.choose({ brushRadius: widthPx / 2 })}
    />
  );
}

function SphereRadius({ store, inspection }: InspectProps) {
  // The default radius depends on the scene.
  useStore(store, (state) => state.inspecting.selecting.sphereRadius);
  const { selecting } = inspection;
  return (
    <div className="inspect-actions">
      <div className="select-radius">
        <span aria-hidden="true">Radius</span>
        <NumberField
          label="Radius, scene units"
          value={selecting.sphereRadius}
          step="any"
          min={0}
          testId="select-radius"
          onChange={(radius) => {
            selecting.sphereRadius = radius;
          }}
        />
        <span aria-hidden="true">units</span>
      </div>
      <PickMiddle inspection={inspection} />
    </div>
  );
}

function Tolerance({ store, inspection }: InspectProps) {
  const { tolerance, picked } = useStore(store, (state) => state.inspecting.selecting);
  return (
    <>
      <Slider
        label="Tolerance"
        min={0}
        max={255}
        value={tolerance}
        shown={String(tolerance)}
        aria-valuetext={`${tolerance} of 255 in each channel`}
        title="In 255ths, in each channel"
        testId="select-tolerance"
        onValue={(value) => {
          inspection.selecting.tolerance = value;
        }}
      />
      <div className="inspect-actions">
        {picked?.kind === 'color' && (
          <span className="select-color" data-testid="select-base-color">
            <i style={{ background: `rgb(${picked.color.join(' ')})` }} />
            {picked.color.join(', ')}
          </span>
        )}
        <PickMiddle inspection={inspection} />
      </div>
    </>
  );
}

/** A button that replaces a click for users without a pointer. */
function PickMiddle({ inspection }: Pick<InspectProps, 'inspection'>) {
  return (
    <TextButton testId="select-middle" onClick={() => inspection.pickMiddle()}>
      Pick the middle of the picture
    </TextButton>
  );
}
