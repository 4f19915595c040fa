/** A line of the figures: a name, and a figure of the image or one of each side. */
export function HudRow({
  label,
  figure,
  rightFigure,
  unit,
  swatch,
  title,
  className,
  isOptional = false,
  testId,
}: {
  label: string;
  figure: string;
  /** The figure of the right side of a split image; undefined for other images. */
  rightFigure?: string;
  unit?: string;
  /** Class of a small square in the colour of a bar. */
  swatch?: string;
  title?: string;
  className?: string;
  /** Whether the line is hidden while its figures are empty. */
  isOptional?: boolean;
  /** Test id of the left side's figure; the right side's figure has `right-` before it. */
  testId?: string;
}) {
  const cell = (text: string, id: string | undefined) => (
    <dd>
      <span data-testid={id}>{text}</span>
      {unit && <small> {unit}</small>}
    </dd>
  );
  return (
    <div className={className} title={title} hidden={isOptional && !figure && !rightFigure}>
      <dt>
        {swatch && <i className={swatch} aria-hidden="true" />}
        {label}
      </dt>
      {cell(figure, testId)}
      {rightFigure !== undefined && cell(rightFigure, testId && `right-${testId}`)}
    </div>
  );
}

/** A bar whose parts are as wide as their shares. */
export function HudBar({ parts }: { parts: readonly (readonly [className: string, share: number])[] }) {
  return (
    <div className="hud-bar" aria-hidden="true">
      {parts.map(([className, share]) => (
        <i key={className} className={className} hidden={share === 0} style={{ flexGrow: share }} />
      ))}
    </div>
  );
}
