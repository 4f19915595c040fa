import { useStore } from 'zustand';
import { formatCount, formatSplats } from '../formatting/format.ts';
import { Action, StepActions } from '../inspecting/actions.tsx';
import type { InspectProps } from '../inspecting/inspect-props.ts';
import type { SelectMode, SelectTool } from '../state/selecting.ts';
import { type Choice, Choices } from '../ui/choices.tsx';
import { Slider } from '../ui/slider.tsx';
import { countOf } from './row-masks.ts';
import './select-tab.css';

const TOOLS: readonly Choice<SelectTool>[] = [
  ['rectangle', 'Rectangle'],
  ['brush', 'Brush'],
  [null, 'Orbit', 'turn'],
];
const MODES: readonly Choice<SelectMode>[] = [
  ['replace', 'New'],
  ['add', 'Add'],
  ['subtract', 'Subtract'],
];
const BRUSH_PX = { least: 4, most: 120 } as const;

/** Selects splats in the picture, removes them, and saves them or the others. */
export function SelectTab({ store, inspection }: InspectProps) {
  const { selected, removed, tool, mode } = useStore(store, (state) => state.inspecting.selecting);
  const marked = useStore(store, (state) => state.inspecting.marked);
  const total = useStore(store, (state) => state.scene?.splats ?? 0);
  const canSave = useStore(store, (state) => state.scene?.canSave ?? false);
  const { selecting } = inspection;
  const save = (savesSelection: boolean) => {
    selecting.choose({ savesSelection });
    store.setState({ dock: 'save' });
  };
  const [selectedCount, removedCount] = [countOf(selected), countOf(removed)];
  return (
    <div className="inspect-sections">
      <Choices
        label="Dragging over the picture"
        choices={TOOLS}
        chosen={tool}
        testId="select-"
        onChoose={(each) => selecting.choose({ tool: each })}
      />
      <p>
        {tool
          ? 'A drag over the picture selects splats by their centres, however deep: Shift adds, Alt subtracts. Two fingers, the right button and keys move the camera.'
          : 'A drag orbits the scene.'}
      </p>
      {tool === 'brush' && <BrushSize store={store} inspection={inspection} />}
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
      <p className="select-count" role="status" data-testid="select-count">
        {`${formatCount(selectedCount)} of ${formatCount(total)} splats are selected.`}
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
        <StepActions store={store} inspection={inspection} />
        {removed.size > 0 && (
          <Action testId="select-restore" onClick={() => selecting.restore()}>
            Bring all back
          </Action>
        )}
      </div>
      {canSave && (
        <div className="inspect-actions">
          <Action testId="select-save" isOff={selected.size === 0} onClick={() => save(true)}>
            Save the selection
          </Action>
          <Action testId="select-save-left" isOff={removed.size === 0} onClick={() => save(false)}>
            Save what is left
          </Action>
        </div>
      )}
    </div>
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
