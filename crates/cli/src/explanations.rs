//! What each code means, for `explain`.

/// Codes of the crates other than io, which has its own list.
const EXPLANATIONS: &[(&str, &str)] = &[
    (
        "E-affine-singular",
        "An affine map flattens space and has no inverse; give one with a determinant that is not 0.",
    ),
    ("E-attribute-duplicate", "Two attributes of one element kind have the same name."),
    ("E-attribute-length", "An attribute has another number of elements than the shape."),
    ("E-attribute-list", "The lists of an attribute start out of order, or end elsewhere than its values."),
    ("E-attribute-text", "A text attribute has an index without a name, or more than one text an element."),
    ("E-attribute-width", "The number of an attribute's values is no multiple of its width."),
    ("E-bezier-count", "A control net has another number of points than its degrees ask for: (m + 1)(n + 1)."),
    ("E-bezier-degree", "A Bézier degree is above 255, beyond which an evaluation takes over a millisecond."),
    ("E-bezier-empty", "A curve has no control points."),
    ("E-bezier-finite", "A control point is infinite or not a number."),
    ("E-blobs-center", "A centre of a blob is infinite or no number. Centres must be finite."),
    ("E-blobs-count", "There are more blobs than a field may have, 2^31."),
    (
        "E-blobs-cutoff",
        "The share of the threshold that blobs without an end may lose where they are cut off is above 0 and at most 0.1.",
    ),
    ("E-blobs-empty", "A field of blobs needs at least one blob."),
    (
        "E-blobs-parameter",
        "A parameter of a blob is outside its range: radii and decays are above 0, amplitudes and weights other than 0, blobbiness above 0 and at most 64 (Blinn wrote it negative).",
    ),
    (
        "E-blobs-strength",
        "The sizes of the peaks of all blobs add up to more than 1e37, which single precision does not hold.",
    ),
    (
        "E-blobs-threshold",
        "The threshold of blobs must be above 0: far from all blobs their sum is 0, and all of space would be inside.",
    ),
    (
        "E-blobs-unreachable",
        "The threshold of blobs is at least the sum of all their peaks, so that nothing is inside anywhere.",
    ),
    (
        "E-boolean-volume",
        "The file is not one volume. Operations on two volumes need a grid of samples each; a mesh becomes one by mesh-to-distance or voxelize-mesh.",
    ),
    ("E-bvh-count", "There are more triangles than 32-bit ids can tell apart."),
    ("E-bvh-finite", "A triangle's corner is infinite or not a number."),
    ("E-bvh-index", "A triangle names a vertex that does not exist."),
    ("E-camera-bounds", "There is nothing to fit into the picture, or the picture has no size."),
    ("E-camera-fov", "The angle of view is not between 0 and 180 degrees."),
    ("E-camera-height", "The height of a parallel view is not a positive number."),
    ("E-camera-view", "The view direction is zero or parallel to the up direction."),
    ("E-cancelled", "The work was interrupted; nothing was written."),
    ("E-check-kind", "The file holds nothing with a surface that could be checked: points, lines, or nothing at all."),
    ("E-compare-count", "A shape has more vertices than 32-bit ids can tell apart."),
    ("E-compare-empty", "A file holds nothing that has a distance: no surface, lines or points."),
    ("E-curve-empty", "A generalised cylinder needs at least one curve."),
    ("E-curve-piece", "A curve of a generalised cylinder has no control points, or one that is not finite."),
    ("E-curve-radius", "The radius of a generalised cylinder must be a finite number, at least 0."),
    (
        "E-curve-tolerance",
        "The tolerance with which the curves of a generalised cylinder are flattened must be above 0, and not so small that more than four million segments are needed.",
    ),
    ("E-distance-empty", "A shape without triangles, segments or points has no distance from anything."),
    (
        "E-distance-sample",
        "A sample of a shape has a position that is not finite, or a weight, a radius or a distance to the other shape that is negative or not finite. The message names the sample by its number.",
    ),
    (
        "E-edit-border",
        "The operator would close a border or make it touch itself, or it needs faces on both sides of an edge that lies on the border. Choose another edge, or fill the hole first.",
    ),
    (
        "E-edit-corners",
        "The operator needs triangles beside the edge, or two corners of one face that are not neighbours. Triangulate the faces first.",
    ),
    (
        "E-edit-duplicate",
        "The operator would make a second edge between the same vertices, or a second face with the same corners.",
    ),
    ("E-edit-fold", "A face would turn over, or lose its area. Choose another place, or allow larger turns."),
    (
        "E-edit-full",
        "The mesh has as many elements as numbers of 32 bits can tell apart. Compact it, which frees the numbers of deleted elements.",
    ),
    (
        "E-edit-gone",
        "An operator on a mesh was given an element that is not there, or was deleted. Numbers of deleted elements are not used again; find the element anew.",
    ),
    (
        "E-edit-link",
        "Collapsing, joining or removing here would glue parts of the surface together that only an edge or vertex should join (link condition). Choose another edge, or split an edge near it first.",
    ),
    ("E-edit-manifold", "Lists of triangles can be edited only where at most two triangles meet in an edge."),
    ("E-edit-valence", "The vertex has too few edges to be removed: no face would be left."),
    ("E-frame-parallel", "Two directions that should span a frame are parallel or zero."),
    ("E-homogeneous-weight", "A combination of points is neither a point (weights sum to 1) nor a vector (0)."),
    (
        "E-implicit-bounds",
        "The box in which the shape is looked at is empty, flat or not finite. Give two corners with finite coordinates, the second larger along each axis.",
    ),
    ("E-implicit-empty", "A union, intersection or difference has no parts. Give it at least one."),
    (
        "E-implicit-parameter",
        "A number of an implicit shape is outside its range: a radius of 0 or below, an alpha of an R-function outside (-1, 1], a map that flattens space. The message names the operation, the parameter and the part. Correct the number.",
    ),
    (
        "E-implicit-region",
        "The region in which an implicit shape is sampled is no box: a corner is not finite, or a coordinate of the first corner is not below that of the second. Give six finite numbers, the least corner first, or auto.",
    ),
    (
        "E-implicit-steps",
        "The shape, with its shared parts written out at each of their places, takes more than two million steps. Parts that are shared inside bent space multiply: use fewer levels, or a repeat instead of copies of copies.",
    ),
    (
        "E-implicit-unbounded",
        "No box was found outside of which the shape is proven to be empty: it has no end, such as a half-space, or nothing is known of its values far away. Say where to look by the option region, six numbers from the least to the greatest corner; the shape is cut off there.",
    ),
    ("E-input-open", "The input file does not exist, is a folder, or may not be read."),
    (
        "E-judge-finite",
        "A vertex of a mesh is at a position that is infinite or not a number, so nothing about its geometry can be decided. Repair the file, or leave such vertices out with --drop-non-finite.",
    ),
    (
        "E-judge-query",
        "A point that was asked about is not finite, or so close to a coordinate plane beside the shape's size (below about 1e-86 of it) that exact arithmetic would lose bits.",
    ),
    (
        "E-judge-underflow",
        "A coordinate is so small beside the largest of the shape (below about 1e-86 of it) that exact arithmetic on it would lose bits. Nothing is guessed: set coordinates that small to 0.",
    ),
    (
        "E-lattice-placement",
        "The steps between the samples of a grid are not finite or lie in one plane: the grid would have no volume. Check the spacing and the directions.",
    ),
    (
        "E-lattice-samples",
        "The number of samples is not the product of the dimensions. Check the header, or the order and number of the values.",
    ),
    (
        "E-lattice-size",
        "A grid needs at least one sample in each direction, and holds at most 2^40, of which a slab holds 2^31.",
    ),
    ("E-lattice-spacing", "The distance between samples must be a positive number in each direction."),
    (
        "E-memory-budget",
        "The work needs more memory than --max-memory allows; ask for a coarser result, or allow more.",
    ),
    ("E-mesh-corners", "A polygon has fewer than three corners."),
    ("E-mesh-edge", "An edge names a vertex that does not exist."),
    ("E-mesh-grid", "A height field's number of heights is not its columns times its rows, both from 2."),
    ("E-mesh-index", "A face names a vertex that does not exist."),
    ("E-mesh-position", "A position is infinite or not a number."),
    ("E-mesh-size", "There are more elements than 32-bit ids can tell apart."),
    ("E-mesh-starts", "The corners of polygon faces are listed out of order."),
    ("E-mesh-triangle", "A polygon stands where only triangles fit; triangulate first."),
    (
        "E-octree-end",
        "The bits of an octree end before its last node: the data is cut off or belongs to another lattice.",
    ),
    (
        "E-octree-equal",
        "The bits of an octree have eight equal leaves where the code has one leaf: the data is damaged.",
    ),
    (
        "E-octree-trailing",
        "The bits of an octree go on after its last node: the data is damaged or belongs to another lattice.",
    ),
    ("E-option-range", "An option's number is outside its bounds; `shapeloom graph` lists options with their bounds."),
    ("E-option-text", "An option's value cannot be read as the kind of value it takes."),
    ("E-option-unknown", "A converter has no option of that name; `shapeloom graph` lists them."),
    ("E-output-exists", "The output exists already; --force replaces it."),
    ("E-output-format", "The output's format can be read but not written yet."),
    ("E-output-write", "The output cannot be written: a folder cannot be made, is not writable, or the disk is full."),
    ("E-picture-empty", "Nothing in the shape has a surface that could be drawn."),
    ("E-picture-format", "Pictures are written as PNG; give the output that extension."),
    (
        "E-picture-size",
        "The shape is so large, so small or so far away that no view takes it in: squares of its coordinates are beyond the numbers.",
    ),
    ("E-plan-method", "No converter has the name given with --method; `shapeloom graph` lists them."),
    (
        "E-plan-missing",
        "A converter on the way has an option that follows from nothing else, as the distance of an offset: give it with --set.",
    ),
    ("E-plan-no-way", "No chain of converters leads from what the input holds to what the output format can hold."),
    ("E-plan-off-the-way", "The converter named with --method does not fit between the input and the output."),
    ("E-plan-option", "No converter on the way has the option given with --set."),
    (
        "E-plane-crossing",
        "Edges or loops cross, and crossings=refuse asks for that to be an error. crossings=split cuts them where they cross.",
    ),
    ("E-plane-edge", "An edge could not be put into a triangulation. Please report the shape."),
    (
        "E-plane-vertex",
        "A vertex could not be put between edges that cross or nearly coincide: the library that keeps the triangulation found no place for it. Please report the input; points moved apart or fewer edges will help until then.",
    ),
    (
        "E-project-gradient",
        "A point is to be moved to a surface along the gradient, and there is none: the middle of a ball, or a ridge. Start elsewhere, or look along a ray.",
    ),
    (
        "E-project-stuck",
        "A point moved along the gradient came to a place where values become no smaller, and it is not the surface. Start nearer to the surface, or look along a ray.",
    ),
    (
        "E-project-undefined",
        "A point is to be moved to a surface, and the field is not a number there. Start where it is defined.",
    ),
    (
        "E-query-lipschitz",
        "Sphere tracing needs to know how fast a field's values change at most, and this field does not say. Intersect by intervals instead.",
    ),
    (
        "E-query-point",
        "A point, or a corner of a box, of a question to a field is not finite. Give finite coordinates.",
    ),
    (
        "E-query-reach",
        "A ray is to be intersected by intervals or traced, and its reach does not end or is not in order. Cut it off at the shape's bounding box.",
    ),
    (
        "E-query-tolerance",
        "A tolerance of a question to a field is negative, infinite or not a number. Give a length from 0 on.",
    ),
    ("E-ray-direction", "A ray has a direction without a length, or coordinates that are not finite."),
    ("E-render-count", "There are more triangles or positions in a picture than 32-bit ids can tell apart."),
    ("E-render-empty", "There is no triangle to draw."),
    ("E-render-encode", "The picture could not be encoded as PNG."),
    ("E-render-finite", "A position to draw is infinite or not a number."),
    ("E-render-index", "A triangle to draw names a position that does not exist."),
    ("E-render-length", "A list of a scene's mesh does not fit its number of triangles."),
    ("E-render-up", "The up direction of a picture has no length."),
    ("E-rotation-angle", "A rotation's angle is infinite or not a number."),
    ("E-rotation-axis", "A rotation's axis has no length."),
    ("E-rotation-matrix", "A matrix is no rotation: its columns are not perpendicular unit vectors, or it mirrors."),
    (
        "E-section-cells",
        "A plane section would look at more cells than max_cells allows. Take larger cells, a larger tolerance or a smaller window, or allow more.",
    ),
    (
        "E-section-fine",
        "A cell size or chord tolerance is too small for the window: cells would be halved more than 40 times. Take a larger one, or a smaller window.",
    ),
    (
        "E-section-window",
        "The window of a plane section is empty or not finite. Its second corner must lie above and to the right of the first.",
    ),
    ("E-shape-kind", "A shape is of another kind than an operation takes; convert it first."),
    (
        "E-shape-text-argument",
        "A function or operator in a text of a shape has too many, too few or the wrong kind of arguments.",
    ),
    ("E-shape-text-encoding", "A text of a shape has bytes that are not UTF-8; save it as UTF-8."),
    ("E-shape-text-foreign", "A field from elsewhere that a text of a shape names could not be made."),
    ("E-shape-text-function", "A text of a shape calls a function that does not exist."),
    ("E-shape-text-name", "A text of a shape uses a name that nothing defines; names of functions need parentheses."),
    ("E-shape-text-number", "A number in a text of a shape is larger than double precision holds."),
    (
        "E-shape-text-order",
        "A text of a shape uses a name before its definition, or in a circle; definitions come first.",
    ),
    ("E-shape-text-parameter", "A parameter in a text of a shape is outside its range."),
    (
        "E-shape-text-resolver",
        "A text of a shape names a field from elsewhere, such as a file, where nothing looks such names up.",
    ),
    (
        "E-shape-text-size",
        "A text of a shape has more operations, arguments or parentheses than a program may have steps.",
    ),
    ("E-shape-text-syntax", "A word or sign cannot stand where it does in a text of a shape."),
    ("E-shape-text-twice", "A text of a shape defines a name twice, or one of x, y, z, pi and deg."),
    ("E-shape-unit", "A unit of length is not a positive number of metres."),
    ("E-strict-tolerance", "With --strict, a result was refused that is not proven to be within the tolerance."),
    (
        "E-structure-corner",
        "A face names the same vertex twice, which half-edges, winged edges and corner tables cannot hold: a walk around the face would pass the vertex twice. Remove the face or split it at the vertex; indexed faces and face-vertex lists hold it as it is.",
    ),
    (
        "E-structure-edge",
        "An edge has more than two faces, which structures for manifolds cannot hold: an edge has one face on each side there. The message names the first such edge, its faces and how many more there are. Split the surface along the edge, or use a structure that holds any faces: indexed faces, face-vertex lists, incidence matrices.",
    ),
    ("E-structure-faces", "The source has edges alone; which faces they bound cannot be told from them."),
    (
        "E-structure-inconsistent",
        "Parts of a structure contradict each other: an element names another that does not name it back, or that does not exist.",
    ),
    (
        "E-structure-one-sided",
        "A part of the surface has one side only, like a Möbius strip: going along the ring of faces that the message names, from each to the next across their common edge, comes back to the first face turned over. No choice of directions makes neighbours agree. Cut the surface along an edge of the ring, remove a face of it, or leave such parts as they are with leave_one_sided=true.",
    ),
    (
        "E-structure-orientation",
        "Two faces pass their common edge in the same direction, so that one of them looks outward and the other inward. Orient the mesh first (convert with --method orient-faces).",
    ),
    (
        "E-structure-query",
        "This structure does not hold the elements that the query is about: an adjacency matrix has no faces, a soup no shared vertices. Ask another structure; the table of the command structures shows which can answer what.",
    ),
    (
        "E-structure-vertex",
        "At a vertex the faces form more than one fan, as where two cones meet in their apex: turning about the vertex from face to face does not pass all of them. Double the vertex, or use a structure that holds any faces.",
    ),
    (
        "E-structures-mix",
        "The mix of a workload is a list of KEY=N separated by commas. Keys are the nine queries VV, VE, VF, EV, EE, EF, FV, FE, FF, queries for all nine alike, updates for changes of the mesh, and size; numbers are finite and not negative, and at least one query or update is asked. Example: --mix VV=1e6,VF=2e5,updates=100.",
    ),
    (
        "E-tessellation-overflow",
        "Control points are so far apart that their differences overflow; scale the shape down.",
    ),
    (
        "E-tessellation-rounding",
        "The tolerance is smaller than the rounding of coordinates at this size; no mesh meets it.",
    ),
    ("E-tessellation-segments", "A curve or patch needs more segments than its option max_segments allows."),
    ("E-tessellation-size", "The tolerance asks for more vertices than 32-bit ids can tell apart."),
    ("E-time-limit", "The work took longer than --max-time allows; nothing was written."),
    ("E-tolerance-range", "A tolerance is not a positive finite number."),
    ("E-tolerance-scale", "A tolerance in per cent needs a shape with a size; give one in model units."),
    ("E-tolerance-text", "A tolerance is neither a number nor a number with %."),
    ("E-usage-code", "There is no error or warning code of that name."),
    ("E-usage-color", "--color distance goes with --reference FILE, and --color-range with it."),
    ("E-usage-format", "The format of standard output has to be named with --to."),
    ("E-usage-kind", "There is no kind of shape of that name; `shapeloom graph` lists them."),
    ("E-usage-operation", "An option of the command that goes with another operation: --smooth goes with --op union."),
    ("E-usage-outputs", "Two outputs have one name, or two kinds of data want standard output."),
    ("E-usage-setting", "An option given with --set means nothing here: for this format, or for this command."),
    ("E-usage-shape", "There is no ready shape of that name."),
    (
        "E-usage-shapes",
        "compare takes two shapes or more, or one and --truth, and standard input for one of them at most.",
    ),
    ("E-usage-threads", "That many threads could not be started."),
    ("E-vm-empty", "A list of steps has no step."),
    ("E-vm-encoding", "A list of steps has bytes that are not UTF-8."),
    (
        "E-vm-foreign",
        "A field from elsewhere, such as a mesh, and a sum of blobs have no arithmetic steps: they cannot be written as a list of them.",
    ),
    ("E-vm-name", "A step has an operand that no line above defines."),
    ("E-vm-number", "A constant in a list of steps is not a number in double precision."),
    ("E-vm-opcode", "A list of steps has an opcode that does not exist."),
    ("E-vm-operands", "A step has more or fewer operands than its opcode takes."),
    ("E-vm-size", "A list of steps has more steps than a program may have."),
    ("E-vm-twice", "A list of steps has two steps of the same name."),
    (
        "E-voxels-cells",
        "With this cell size distances or volumes leave single precision, or the lattice has too many samples, or they would fall on each other far from the origin: the message says which. Choose another cell size, resolution, margin or radius, or scale or move the shape.",
    ),
    (
        "E-voxels-cubes",
        "Voxels are made on lattices of cubes along the axes only: the three steps between samples must be equally long, along x, y and z.",
    ),
    (
        "E-voxels-finite",
        "A sample is NaN or infinite where an interpolant needs numbers. Redistancing gives every sample a finite distance.",
    ),
    (
        "E-voxels-lattices",
        "Two grids were to be combined that do not lie on one lattice. Sample both with the same number of samples, spacing and origin.",
    ),
    (
        "E-voxels-overflow",
        "A length, offset, radius or fraction is outside of what the operation can hold in single precision. Scale the shape to a size near 1.",
    ),
    (
        "E-voxels-position",
        "A vertex or point has a coordinate that is NaN or infinite, so it is in no cell. Take it out, or look where it comes from.",
    ),
    (
        "E-voxels-size",
        "A grid has more samples in a direction than an octree (2^21) or sparse bricks (2^24) can address. Resample it coarser.",
    ),
    (
        "E-voxels-steps",
        "Curvature flow would take more than a million steps. Ask for less time, or resample the grid coarser: the number of steps grows with the inverse square of the spacing.",
    ),
    (
        "E-voxels-thin",
        "Level sets need cells, and a lattice that is one sample thick has none. Make meshes of it directly, or resample it with two samples or more in each direction.",
    ),
    (
        "W-boolean-beyond",
        "The second volume was sampled where it has no samples: there the value of its border's nearest point was taken.",
    ),
    (
        "W-cells-merged",
        "Faces of cells were merged into rectangles, which meet in T-junctions: the mesh covers its surface but its edges do not match. Without merge they do.",
    ),
    (
        "W-cells-touch",
        "Full cells touch along an edge alone, where four faces meet: the mesh is not a manifold there. The option separate doubles the vertices.",
    ),
    (
        "W-check-contact",
        "Two faces touch in a point, along a segment or all over, beside the corners and sides that they share.",
    ),
    (
        "W-check-crossing",
        "The inside of a face passes through the inside of another. Decided exactly; faces that only touch do not cross.",
    ),
    ("W-check-degenerate", "A face has no area, decided exactly, or names a vertex twice."),
    ("W-check-duplicate", "A face has the same vertices in the same order, either way around, as an earlier one."),
    ("W-check-edge", "An edge has more than two faces, so the surface is no manifold there."),
    ("W-check-empty", "A mesh has no faces."),
    (
        "W-check-inverted",
        "A closed shell faces the wrong way: an outer shell whose faces look inward, or a shell within another whose faces look outward. A shell in an odd number of others bounds a cavity and faces inward.",
    ),
    ("W-check-isolated", "A vertex belongs to no face."),
    ("W-check-normals", "A mesh to be drawn in real time has no normals, on vertices or on corners."),
    (
        "W-check-open",
        "Edges with only one face: the surface has a border, so it encloses nothing. The places are the first edge of each loop. If vertices lie exactly where others do, check --weld merges them first.",
    ),
    (
        "W-check-orientable",
        "The surface is one-sided, like a Moebius strip: the faces named form a ring, each beside the next, after which the first would be turned over.",
    ),
    (
        "W-check-orientation",
        "Two faces run along their common edge in the same direction, so one of them is turned over.",
    ),
    (
        "W-check-overlap",
        "Two faces lie in one plane, have an area in common and look the same way, or are neighbours folded onto each other: solids that share a volume, or a fin without thickness.",
    ),
    (
        "W-check-polygon",
        "The sides of a polygon meet elsewhere than at the corner between neighbours: it crosses, touches or folds back on itself.",
    ),
    ("W-check-sliver", "A triangle has an area but an angle below one degree, which makes simulations slow or wrong."),
    (
        "W-check-vertex",
        "The faces at a vertex are not one fan around it: parts of the surface meet in that vertex alone.",
    ),
    ("W-check-volume", "A closed surface encloses a volume of 0 or less, so there is nothing to print."),
    (
        "W-compact-collapsed",
        "Triangles lost their area when positions were rounded to the steps of a compact store: two of their corners are the same step. The report says how far vertices moved. Take more bits, or weld and simplify first.",
    ),
    (
        "W-compare-open",
        "A surface has sides that are not passed as often one way as the other, so it encloses no volume.",
    ),
    (
        "W-compare-size",
        "The area or volume of a shape is beyond the largest number, or so small that it vanishes: it is left out. Scale the shape to have them.",
    ),
    (
        "W-dual-contouring-held",
        "The point that fits the planes of a cell best lies outside of the cell, as with planes that nearly agree or with noise; the vertex was put at the nearest place in its cell.",
    ),
    (
        "W-face-turned",
        "Faces were turned by more than a right angle when vertices moved: the mesh is folded there. Ask for less, or start from a mesh that is nearer to what is wanted.",
    ),
    (
        "W-height-no-cell",
        "No cell of a height field has heights at all four corners: each touches a hole, and cells that do are left out. So no triangle is left. Fill the holes before, or check which number the file means as a hole.",
    ),
    (
        "W-height-stray",
        "Some samples of a height field have a height, but each cell around them touches a hole and is left out: no triangle has these samples. The bound of the report is for the surface over whole cells and holds; where there is no whole cell at all the report gives no deviation, as nothing stands for the samples.",
    ),
    (
        "W-height-tolerance",
        "Some cells of a height field are twisted: their four heights lie so far from a plane that triangles come near the surface between them only when the cell is cut into many. They were cut as finely as max_cell_steps allows and are still farther than the tolerance; the report says how far. A tolerance of 0 can be reached by cells without twist alone. Allow more steps with --set max_cell_steps=N, or a larger tolerance.",
    ),
    (
        "W-implicit-empty",
        "The implicit shape is positive everywhere: it holds no point, so the mesh is empty. Look whether an intersection or difference leaves nothing, and at the sign of the field, which is negative inside.",
    ),
    (
        "W-implicit-searched",
        "Bounds over infinite boxes did not prove where the implicit shape ends, so it was searched for up to a stated distance. What lies beyond is not drawn; give the option region to look elsewhere.",
    ),
    (
        "W-info-open",
        "The surface has a border, or faces that share an edge do not turn alike, so it encloses no volume: the number given is the signed volume of the cones from the faces to the centre of the bounding box, and changes with that centre.",
    ),
    (
        "W-info-parts",
        "The file has more than a thousand parts. Each is listed with its counts alone; the whole report is that of all parts together.",
    ),
    (
        "W-info-size",
        "The area or volume of a mesh is too large for the numbers, or so small that it would vanish. Scale the shape, by a power of two if no bit shall change.",
    ),
    (
        "W-iso-empty",
        "The surface has no triangles, and the mesh is empty: no sample is on the other side of the iso value, or the border is open and leaves no cell to draw in. The message gives the range of the samples; set iso to a value between its ends, or border=closed.",
    ),
    (
        "W-iso-not-finite",
        "Samples that are NaN or infinite count as outside; the surface closes around them in the middle of the cells.",
    ),
    (
        "W-iso-otsu",
        "No iso value was given, and the samples are densities, whose scale only they know: Otsu's threshold between two classes of samples was taken. Set iso= to another value if the surface is not the one you want; info gives the range of the samples.",
    ),
    (
        "W-orient-one-sided",
        "A part of the surface has one side only and was left as it is. The ring of faces at the place named comes back to its first face turned over.",
    ),
    (
        "W-patch-degenerate",
        "A patch without area somewhere gave triangles without area; they are kept so that nothing opens.",
    ),
    (
        "W-patch-vanished",
        "A patch, or a part of it, is only a point or a line and left no triangle: the error is unknown there.",
    ),
    (
        "W-planarity-missed",
        "Some quadrilaterals are farther from flat than was asked for. Not every mesh has flat quadrilaterals near it: a grid along the straight lines of a saddle has none, and a border that is held may leave no room. The report says how far they are. Allow more steps, let the border go, or make a grid along the lines of curvature.",
    ),
    (
        "W-planarize-polygons",
        "Polygons of more than four corners are not made flat: only quadrilaterals are. Cut them into quadrilaterals or triangles first.",
    ),
    (
        "W-plane-collinear",
        "All points lie on one line of the plane in which they were to be triangulated, so there is no triangle. Another plane may do: plane=xz, plane=yz, plane=fit.",
    ),
    (
        "W-plane-crossing",
        "Edges or sides of loops cross; both were split at a new vertex, rounded to the nearest numbers. crossings=refuse makes it an error.",
    ),
    ("W-plane-duplicate", "Several points have the same position; the first was kept, with its attributes."),
    (
        "W-plane-earcut",
        "Loops that cross or touch, or of more than 4096 points, are not for earcut; they were triangulated by constrained Delaunay.",
    ),
    (
        "W-plane-empty",
        "The edges enclose nothing, so no triangle was kept. keep=everything keeps all within the convex hull.",
    ),
    (
        "W-plane-height",
        "Several points lie over the same place of the plane at different heights; the first was kept. Another plane may tell them apart: plane=xz, plane=yz, plane=fit.",
    ),
    (
        "W-plane-near",
        "Two edges cross so near to an end of one that rounding could put the crossing on either side of it; the other edge was led through that end, at a distance that the report names.",
    ),
    ("W-plane-open", "A line that is not closed was closed by a straight side to bound a region."),
    ("W-plane-outside", "Points that are no corner of a triangle that is kept were left out."),
    ("W-plane-overlap", "An edge runs over another one; the part that they share counts once."),
    ("W-plane-point", "An edge has no length in the plane of the triangulation; it was left out."),
    ("W-plane-through", "An edge passes through a vertex; it was split there."),
    (
        "W-plane-tiny",
        "Coordinates are so small beside the largest that their products are no numbers; they were taken as 0 in deciding what lies where. Positions are unchanged.",
    ),
    ("W-points-outside", "Points lie outside of the lattice that was given, so no sample knows of them."),
    (
        "W-points-saturated",
        "A cell holds more points than a sample of 16 bits can say: the sample is 65535. Choose smaller cells, or densities instead of counts.",
    ),
    ("W-polygon-simple", "A polygon crosses itself or has no area; it was cut into triangles as well as possible."),
    (
        "W-refine-angle",
        "Edges of the source meet in a smaller angle than was wanted; the triangles between them stay sharp.",
    ),
    (
        "W-refine-blocked",
        "Triangles stay smaller in angle or larger in area than wanted, because edges must not be split. split_edges=true allows it.",
    ),
    (
        "W-refine-flat",
        "Points off the straight border of the hull by rounding alone make triangles that no vertices could make better; these were left out before refining.",
    ),
    (
        "W-refine-limit",
        "The refinement used up the vertices that it may add before all triangles were as wanted. Raise max_added, or ask for a smaller angle or larger area.",
    ),
    ("W-refine-small", "Triangles as small as the rounding of their coordinates stay as they are."),
    (
        "W-section-uncertain",
        "Some cells of a plane section may hold parts of the curve that were not found: bounds of the field do not show that they are free, and no corner lies on another side. Touching or double curves do this, and fields without bounds.",
    ),
    (
        "W-section-undefined",
        "The field is not a number on one side of a curve of a plane section. That side counts as outside, and the curve follows the border of where the field is defined.",
    ),
    (
        "W-surface-nets-edges",
        "Edges of the result have more than two triangles, because two pieces of the surface pass through one cell and share its vertex. The method manifold-surface-nets gives each piece a vertex of its own.",
    ),
    (
        "W-voxels-lost",
        "Parts of the mesh are thinner than a cell, so no sample lies in them, or their faces look inward: the surface that the samples describe leaves them out. Choose smaller cells, or turn the faces.",
    ),
    (
        "W-voxels-nothing",
        "A mesh was sampled, but no sample is inside: it has no volume, is not closed, looks inward or is thinner than a cell. A higher resolution may help; a surface that encloses nothing has no inside.",
    ),
    (
        "W-voxels-open",
        "The mesh is not closed, so inside and outside are not given by it alone. Inside is where the generalised winding number is above 1/2, which closes holes smoothly; there the deviation is not known.",
    ),
];

/// Every code with its meaning.
pub(crate) fn all() -> impl Iterator<Item = (&'static str, &'static str)> {
    EXPLANATIONS.iter().chain(shapeloom_io::EXPLANATIONS).copied()
}

/// What a code means, in a sentence or two.
pub fn explanation(code: &str) -> Option<&'static str> {
    all().find(|(known, _)| *known == code).map(|(_, text)| text)
}
