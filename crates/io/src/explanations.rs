//! What codes mean.

/// Every code of this crate with what it means and what can be done, in the order of the codes.
pub const EXPLANATIONS: &[(&str, &str)] = &[
    ("E-asc-cell", "The size of cells in an ESRI ASCII grid, cellsize or dx and dy, must be above 0."),
    (
        "E-asc-claim",
        "An ESRI ASCII grid says that it has more samples than can be in the rest of the file. Nothing was allocated for them.",
    ),
    ("E-asc-count", "The numbers of columns and rows of an ESRI ASCII grid are whole numbers in digits alone."),
    (
        "E-asc-duplicate",
        "A word of the header of an ESRI ASCII grid stands there twice, or both a corner and a centre are given.",
    ),
    (
        "E-asc-finite",
        "A number of an ESRI ASCII grid is infinite, or larger than the largest double. With the option drop_non_finite (--drop-non-finite) such heights become holes; numbers of the header must be mended.",
    ),
    (
        "E-asc-header",
        "The header of an ESRI ASCII grid has ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize (or dx and dy), and perhaps NODATA_value, each followed by a number. A word is missing or not one of these, or the file is empty.",
    ),
    (
        "E-asc-number",
        "A number was expected in an ESRI ASCII grid and something else was found, such as a decimal comma.",
    ),
    ("E-asc-truncated", "An ESRI ASCII grid ends before it has as many samples as its header says."),
    ("E-bpt-count", "A BPT file begins with the number of patches, in digits alone. Correct the first number."),
    (
        "E-bpt-degree",
        "Each patch of a BPT file begins with two degrees, whole numbers from 1. A patch before it may have too many or too few control points, so that other numbers are read as degrees.",
    ),
    (
        "E-bpt-finite",
        "A coordinate of a control point is infinite, no number, or larger than the largest double. Points must be finite: repair the program that wrote the file.",
    ),
    (
        "E-bpt-limit",
        "The file asks for more patches, control points or a higher degree than the reader's limits allow.",
    ),
    ("E-bpt-number", "A coordinate of a control point was expected and something else was found."),
    ("E-bpt-patch", "The control points of a patch make no Bézier patch."),
    (
        "E-bpt-truncated",
        "The file ends before the number of patches that its first number promises. It was cut off, or the number is wrong.",
    ),
    ("E-dem-claim", "A profile of a USGS DEM says that it has no samples, or more than the file can hold."),
    (
        "E-dem-count",
        "Record A of a USGS DEM says, in its columns 859 to 864, how many profiles there are: at least one.",
    ),
    ("E-dem-feature", "The profiles of this USGS DEM do not run to the north. Such files are not read."),
    ("E-dem-header", "A number in record A of a USGS DEM is none of those that the standard has there."),
    (
        "E-dem-number",
        "A number was expected in these columns of a USGS DEM. Its numbers stand in fixed columns, so that one byte too few or too many moves all that follow.",
    ),
    (
        "E-dem-profile",
        "A profile of a USGS DEM is one sample wide. This record says otherwise; it may not be where a profile begins.",
    ),
    (
        "E-dem-spread",
        "The profiles of a USGS DEM begin so far from each other that the grid around them would be nearly empty. The first place of one of them is probably wrong.",
    ),
    ("E-dem-truncated", "A USGS DEM ends before it has as many profiles and samples as it says."),
    ("E-format-id", "No format has this short name. The list of formats has all of them."),
    (
        "E-format-output",
        "The format of an output follows from its extension, and no format that is written has this one.",
    ),
    (
        "E-format-unknown",
        "Neither the first bytes nor the extension of the input tell its format. Name the format if you know it.",
    ),
    (
        "E-glb-chunk",
        "A chunk of a GLB file claims more bytes than the file's header leaves for it. The file is damaged.",
    ),
    ("E-glb-length", "The length in the header of a GLB file is not that of the file. It was cut off, or damaged."),
    ("E-glb-magic", "A GLB file begins with the letters glTF. This is another kind of file, or its start is damaged."),
    ("E-glb-order", "The first chunk of a GLB file must be JSON."),
    ("E-glb-truncated", "A GLB file ends within its header or one of its chunks. Get the file again."),
    ("E-glb-version", "Only version 2 of the GLB container is read. Convert the file with another program."),
    (
        "E-gltf-bounds",
        "An accessor or a buffer view reaches past the end of its bytes, or its elements overlap. Nothing outside of a buffer is ever read; the program that wrote the file counted wrongly.",
    ),
    ("E-gltf-buffer", "A buffer has fewer bytes than its byteLength, or no bytes at all."),
    ("E-gltf-count", "An accessor has no elements, or attributes of one primitive have different numbers of elements."),
    ("E-gltf-cycle", "A node is its own ancestor. The nodes of a scene must be a tree."),
    ("E-gltf-depth", "Nodes are nested deeper than the reader's limits allow."),
    (
        "E-gltf-extension",
        "The file requires an extension that is not read, so that it cannot be understood without it.",
    ),
    ("E-gltf-feature", "The file uses a part of glTF that is not read: compressed data."),
    (
        "E-gltf-finite",
        "A position is infinite or not a number. Repair the file, or read it with the option drop_non_finite, which leaves out such vertices with the faces that use them.",
    ),
    ("E-gltf-index", "An index of a primitive names a vertex that does not exist."),
    ("E-gltf-json", "The document is not valid JSON. The message names the first place at fault."),
    (
        "E-gltf-limit",
        "The file has more elements than the reader's limits allow, claims very many that are nowhere in it and would all be zeros, or shows the same data so often that what is read would be out of proportion to it.",
    ),
    ("E-gltf-mesh", "The vertices, indices and attributes of a primitive make no mesh."),
    ("E-gltf-missing", "A member that glTF requires is absent."),
    ("E-gltf-mode", "The mode of a primitive is a number from 0, points, to 6, a fan of triangles."),
    (
        "E-gltf-parents",
        "The scene reaches a node twice in the same place. The nodes of a scene must be a tree; instances share a mesh, not a node.",
    ),
    ("E-gltf-reference", "A number names an element of a list that is not there."),
    (
        "E-gltf-sparse",
        "The indices of a sparse accessor must strictly rise and stay below its count. The program that wrote the file did not sort them.",
    ),
    (
        "E-gltf-type",
        "A value has another type than glTF gives it: a string for a number, VEC2 for positions, floating numbers for indices.",
    ),
    ("E-gltf-uri", "An embedded buffer is not base64 data."),
    ("E-gltf-version", "Only version 2.0 of glTF is read."),
    (
        "E-heights-channels",
        "How bright a colour looks is no height. Heights are read from grey pictures, and from colours where the option encoding says how they mean heights: mapbox or terrarium, in 8 bits.",
    ),
    (
        "E-heights-finite",
        "A height is infinite, or becomes so when multiplied by the option exaggeration. Mend the number or choose a smaller exaggeration. With the option drop_non_finite (--drop-non-finite) heights that are infinite in the file become holes.",
    ),
    (
        "E-heights-grid",
        "The places of the samples are not finite numbers, their distances are not above 0, or the places are so large that neighbouring samples fall together: move the grid nearer to the origin.",
    ),
    (
        "E-heights-limit",
        "The header claims more samples than the reader's limits allow for a file of this length. Nothing was allocated for them.",
    ),
    (
        "E-heights-option",
        "An option of reading heights is out of its bounds, or does not apply: the option height is for pictures, whose samples are shades; samples that are heights already are multiplied by the option exaggeration. The option voxel_size is for slices of a volume, which stack=true reads.",
    ),
    (
        "E-heights-size",
        "A height field has at least two columns and two rows: between fewer samples there is no surface.",
    ),
    (
        "E-metaimage-count",
        "A number of a MetaImage header is no whole number in digits alone, or a line has too few or too many numbers.",
    ),
    ("E-metaimage-dimension", "A volume has three dimensions and one number a sample; this MetaImage has others."),
    ("E-metaimage-duplicate", "A key of a MetaImage header is there twice."),
    (
        "E-metaimage-feature",
        "The file uses a part of MetaImage that is not read: another object than an image, or samples in several files.",
    ),
    (
        "E-metaimage-header",
        "A line of a MetaImage header is no key with = and a value, or a key that is needed is missing: NDims, DimSize, ElementType, and at the end ElementDataFile.",
    ),
    ("E-metaimage-number", "A number of a MetaImage header does not read as one."),
    (
        "E-metaimage-type",
        "The element type of a MetaImage is one of MET_CHAR, MET_UCHAR, MET_SHORT, MET_USHORT, MET_INT, MET_UINT, MET_LONG_LONG, MET_ULONG_LONG, MET_FLOAT and MET_DOUBLE.",
    ),
    (
        "E-molecule-count",
        "The first line of an XYZ file of a molecule is the number of its atoms, a whole number above 0 and nothing else.",
    ),
    ("E-molecule-finite", "A coordinate of an atom in an XYZ file is infinite or no number. It must be finite."),
    ("E-molecule-limit", "An XYZ file has more atoms than the reader's limits allow."),
    (
        "E-molecule-number",
        "A coordinate of an atom in an XYZ file is missing or no decimal number. Each line has an element and three numbers, apart by blanks.",
    ),
    ("E-molecule-truncated", "An XYZ file of a molecule ends before it has as many atoms as its first line says."),
    (
        "E-nrrd-count",
        "A number of axes or samples, or of bytes or lines that are passed over, is no whole number in digits alone, or a field has another number of values than the file has axes.",
    ),
    (
        "E-nrrd-dimension",
        "A volume has three axes of space and one number a sample. An NRRD with two or four axes, or with an axis of vectors, colours or tensors, is another thing; take one of its components with another program first.",
    ),
    ("E-nrrd-duplicate", "A field of an NRRD header is there twice."),
    (
        "E-nrrd-feature",
        "The file uses a part of NRRD that is not read: the encodings hex and bzip2, or samples in several files. Write it anew as raw or gzip in one file.",
    ),
    (
        "E-nrrd-header",
        "A line of an NRRD header is none of: a field with a colon, a key with :=, a comment from #, the blank line at its end; or a field that is needed is missing: type, dimension, sizes, encoding, and endian where a raw sample has several bytes.",
    ),
    ("E-nrrd-magic", "An NRRD file begins with NRRD000 and a digit."),
    (
        "E-nrrd-number",
        "A number of an NRRD header does not read as one, or a vector is not written as three numbers in brackets, such as (1,0,0).",
    ),
    (
        "E-nrrd-type",
        "The type of an NRRD is one of int8, uint8, int16, uint16, int32, uint32, int64, uint64, float and double, or another of the names that the format has for them.",
    ),
    ("E-nrrd-version", "The file is of a version of NRRD that is not known: 1 to 5 are."),
    ("E-obj-degree", "A free-form curve or surface has too few control points for its degree."),
    (
        "E-obj-finite",
        "A coordinate is infinite, not a number, or beyond 1.8e308. Vertices are counted from 0 here. `--drop-non-finite` leaves such vertices out.",
    ),
    ("E-obj-freeform", "The file holds free-form curves or surfaces, which are not read yet. Export it as polygons."),
    (
        "E-obj-index",
        "A face, line or point names something that does not exist. OBJ counts from 1, and from -1 backwards.",
    ),
    ("E-obj-limit", "The file has more elements or a larger polygon than the limits allow."),
    ("E-obj-mesh", "The elements do not make a mesh."),
    (
        "E-obj-number",
        "A number, or the index of a corner, does not read as one. Decimal numbers only: no commas, no hexadecimal.",
    ),
    ("E-obj-row", "A vertex, normal or texture coordinate has too few or too many numbers."),
    ("E-obj-truncated", "The file ends within a free-form curve or surface."),
    (
        "E-off-claim",
        "The counts of an OFF file, or the number of corners of a face, are more than the bytes that follow can hold. The file was cut off, or a number is wrong.",
    ),
    (
        "E-off-color",
        "A colour is three or four numbers, fractions from 0 or whole numbers from 0 to 255; one whole number is an index into a colour map.",
    ),
    ("E-off-count", "A count is below zero."),
    ("E-off-dimension", "Only vertices of one to three coordinates are read. Project shapes of more dimensions first."),
    (
        "E-off-finite",
        "A coordinate is infinite, no number, or larger than the largest double. Repair the program that wrote the file, or have vertices that are not finite left out.",
    ),
    ("E-off-header", "An OFF file begins with a keyword such as OFF, COFF or NOFF, or with its number of vertices."),
    ("E-off-index", "A face names a vertex that does not exist. Vertices are counted from 0."),
    ("E-off-limit", "The file has more vertices, faces or corners of one face than the reader's limits allow."),
    (
        "E-off-number",
        "A number was expected and something else was found. Counts and the numbers of vertices are digits alone; numbers have a decimal point, never a comma.",
    ),
    (
        "E-off-row",
        "A line has too many or too few numbers. Each vertex and each face is on one line. Where the first line of the faces is named, the header may promise more vertices than are listed.",
    ),
    ("E-off-truncated", "The file ends before the numbers of vertices and faces that its header promises."),
    ("E-off-weight", "A vertex of a 4OFF file has the homogeneous weight 0: it is infinitely far away."),
    (
        "E-pdb-finite",
        "A coordinate of an atom in a Protein Data Bank file is infinite or no number. It must be finite.",
    ),
    ("E-pdb-limit", "A Protein Data Bank file has more atoms than the reader's limits allow."),
    (
        "E-pdb-number",
        "A coordinate of an atom was expected in columns 31 to 38, 39 to 46 or 47 to 54 of a Protein Data Bank file, and something else was found. One byte too few or too many in a line moves all that follow.",
    ),
    (
        "E-pdb-row",
        "The line of an atom in a Protein Data Bank file ends before its coordinates, which stand in columns 31 to 54.",
    ),
    ("E-pdb-truncated", "A Protein Data Bank file has no record ATOM or HETATM. It was cut off, or is another file."),
    ("E-pgm-count", "A PGM file has the numbers of columns and rows in its header, in digits alone."),
    ("E-pgm-magic", "A PGM file begins with P2 or P5. Other kinds of Netpbm, of bits or colours, are no heights."),
    ("E-pgm-maxval", "The largest value that a PGM file says is a whole number from 1 to 65535."),
    ("E-pgm-number", "A sample of a PGM file in text is a whole number in digits alone."),
    ("E-pgm-truncated", "A PGM file ends within its header, or before it has as many samples as that says."),
    ("E-pgm-value", "A sample of a PGM file is larger than the largest value that its header says."),
    (
        "E-ply-claim",
        "The header of a PLY file promises more rows than the bytes after it have room for. The file was cut off, or its header is wrong. Nothing is allocated because a header says so.",
    ),
    (
        "E-ply-count",
        "The number of rows of an element, or the length of a list, is a whole number from 0, in digits alone.",
    ),
    (
        "E-ply-duplicate",
        "An element, a property of an element or the format is there twice, so that one of them has the wrong name.",
    ),
    (
        "E-ply-finite",
        "A coordinate of a vertex is infinite, no number, or larger than its type can hold. Repair the program that wrote the file, or leave such vertices out (drop_non_finite).",
    ),
    (
        "E-ply-format",
        "The header says before its elements how the numbers are laid down: \"format ascii 1.0\", \"format binary_little_endian 1.0\" or \"format binary_big_endian 1.0\".",
    ),
    (
        "E-ply-header",
        "A line of the header is not one of those that PLY has, or stands in the wrong place; or vertices have no x, y and z.",
    ),
    (
        "E-ply-index",
        "A face, edge or strip names a vertex that does not exist. Vertices are counted from 0. In a binary file the byte order may be another one than the header says.",
    ),
    ("E-ply-limit", "The file has more elements, properties or corners of a face than the reader's limits allow."),
    ("E-ply-magic", "A PLY file begins with the line \"ply\". This is another kind of file, or its start is damaged."),
    (
        "E-ply-number",
        "A value was expected and something else was found, or a whole number beyond the range of its type.",
    ),
    (
        "E-ply-row",
        "A line of the body has more or fewer values than the element has properties. Each row has a line of its own; a list is its length and then its numbers.",
    ),
    (
        "E-ply-truncated",
        "The file ends within its header or its body. It was cut off, or its header promises too much.",
    ),
    ("E-ply-type", "A property has a type that PLY does not have, or the length of a list is no whole number."),
    (
        "E-png-checksum",
        "A chunk of a PNG file that is needed does not have the checksum that it should have. The file was damaged.",
    ),
    (
        "E-png-claim",
        "The header of a PNG file claims more pixels than its compressed data can hold. Nothing was allocated for them.",
    ),
    ("E-png-data", "The compressed data of a PNG file is damaged, though its checksums are right."),
    (
        "E-png-header",
        "The chunk IHDR of a PNG file does not say what the standard has: a size, a colour type with a depth that it can have, compression 0, filter 0, interlace 0 or 1.",
    ),
    ("E-png-limit", "A row of a PNG file takes more memory than is allowed."),
    (
        "E-png-magic",
        "A PNG file begins with eight bytes of its own. This is another kind of file, or its start is damaged.",
    ),
    ("E-png-order", "The first chunk of a PNG file must be IHDR."),
    ("E-png-truncated", "A PNG file ends before its last chunk is complete, or its data before the last row."),
    ("E-read-elements", "There are more elements than 32 bits can tell apart. Cut the shape into parts."),
    ("E-read-format", "Files of this format are recognized and written, but not read yet."),
    ("E-read-io", "The input could not be read to its end."),
    ("E-read-size", "The input is longer than the reader's limits allow. Raise the limit if you trust it."),
    (
        "E-sibling-missing",
        "The input names a file beside it that is not there, too long or unreadable, or the input is read alone so that nothing is beside it.",
    ),
    ("E-sibling-path", "The input names a file outside of its own folder. Such files are never opened."),
    (
        "E-slc-count",
        "A number of an SLC header is no whole number in digits alone, or a number of bytes is not followed by an X.",
    ),
    (
        "E-slc-feature",
        "The file is of a kind of SLC that is not read: other than 8 bits a sample, or another compression than run lengths.",
    ),
    ("E-slc-magic", "An SLC file begins with 11111."),
    ("E-slc-number", "A distance in an SLC header does not read as a number."),
    (
        "E-stl-claim",
        "The count of a binary STL file is larger than its number of bytes, so that it cannot be right. It may be in the other byte order, or the file may be no STL.",
    ),
    (
        "E-stl-finite",
        "A coordinate is infinite, no number, or larger than the largest double. Repair the program that wrote the file, or have vertices that are not finite left out.",
    ),
    (
        "E-stl-limit",
        "The file has more facets or solids than the reader's limits allow, more solids than its length gives reason for, or more facets than 32 bits can count the corners of.",
    ),
    (
        "E-stl-number",
        "A coordinate was expected and something else was found. Numbers have a decimal point, never a comma.",
    ),
    (
        "E-stl-row",
        "Another word was expected here. A facet is: facet normal, outer loop, three times vertex with three numbers, endloop, endfacet.",
    ),
    ("E-stl-truncated", "The file ends before its last facet does. It was cut off; get it again."),
    ("E-text-encoding", "The text is in UTF-16 or UTF-32. Save it as UTF-8."),
    ("E-text-line", "A line is longer than the reader's limits allow. It may not be text at all."),
    (
        "E-tiff-claim",
        "A TIFF file claims more samples than compressed data of its length can hold, or has a tag, strip or tile larger than the image. Nothing was allocated for them.",
    ),
    ("E-tiff-data", "A tag or the compressed data of a TIFF file is damaged or missing."),
    (
        "E-tiff-feature",
        "Heights are read from TIFF files of one channel of 8 to 64 bits, from grey with transparency and from colours of 8 or 16 bits side by side; plain or compressed by LZW, deflate or PackBits. This file is of another kind.",
    ),
    ("E-tiff-limit", "A tag of a TIFF file has more than 1 MiB: so many strips or tiles are not read."),
    (
        "E-tiff-strip",
        "The tags that say where the strips or tiles of a TIFF file are, or how many rows and bytes each has, contradict each other or the file: one begins outside of the file, or has fewer bytes than its pixels need. Files with strips left out because they are empty are of this kind too. Write the file anew with another program.",
    ),
    ("E-tiff-truncated", "A TIFF file ends before its tags or its data."),
    (
        "E-volume-claim",
        "The header of a volume says that it has more samples than can be in the bytes that follow. Nothing was allocated for them. Mend the sizes, or get a complete copy of the file.",
    ),
    (
        "E-volume-data",
        "The compressed samples of a volume cannot be unpacked, or their checksum is wrong: the file was damaged.",
    ),
    (
        "E-volume-grid",
        "The steps between the samples of a volume are no numbers, are 0 or lie in one plane, its places are no numbers, or they are so large that neighbouring samples would be at the same one. Mend the spacing, the directions and the origin in the header.",
    ),
    (
        "E-volume-limit",
        "A volume has more samples than the limits of reading allow for a file of so many bytes: compressed, a small file may become a very large one. Cut the volume into parts, or store it without compression.",
    ),
    ("E-volume-number", "A sample of a volume in text is no number, or none that its type can hold."),
    (
        "E-volume-option",
        "An option of reading volumes is missing, is for something else, or does not read as it should. A raw volume needs dimensions; slices of a stack take voxel_size, and no option of height fields. dimensions and voxel_size are three numbers with x between, such as 256x256x128; voxel_size may be one number too.",
    ),
    ("E-volume-size", "A volume has no samples in some direction."),
    (
        "E-volume-spacing",
        "The distances between the samples of a volume are finite numbers above 0. Mend the spacing in the header.",
    ),
    (
        "E-volume-stack",
        "The slices of a volume are pictures of one size and depth. Their names differ in a number before the extension, such as slice_000.png, without a gap; the first one is read with --set stack=true.",
    ),
    (
        "E-volume-trailing",
        "Unpacking gives more bytes than the header of a volume says that there are samples. Nothing beyond them was unpacked. Mend the sizes or the type in the header.",
    ),
    (
        "E-volume-truncated",
        "The samples of a volume end before all of them are there: the file was cut off, or its header says too many.",
    ),
    ("E-vti-data", "What stands inside a binary array of a VTI file is no base64."),
    (
        "E-vti-dimension",
        "A volume has one number a sample; the array of the VTI file has several components. Take one of them with another program first.",
    ),
    (
        "E-vti-feature",
        "The file uses a part of the XML formats of VTK that is not read: another kind of data than ImageData, several pieces, or another compressor than zlib.",
    ),
    ("E-vti-header", "An element or attribute that a VTI file must have is not there."),
    (
        "E-vti-length",
        "The array of a VTI file has another number of bytes than the extent and the type of its numbers say.",
    ),
    ("E-vti-limit", "The elements of a VTI file are nested deeper than any such file needs."),
    (
        "E-vti-number",
        "An attribute of a VTI file does not have as many numbers as it must, or they do not read as numbers.",
    ),
    ("E-vti-truncated", "A VTI file ends before its last element is complete."),
    ("E-vti-type", "The type of an array in a VTI file is one of Int8 to UInt64, Float32 and Float64."),
    ("E-vti-value", "An attribute of a VTI file has a value that it cannot have."),
    ("E-vti-xml", "A VTI file is no well-formed XML at this place."),
    (
        "E-vtk-count",
        "A number of a legacy VTK header is no whole number in digits alone, or the number of samples is not the product of the dimensions.",
    ),
    ("E-vtk-dimension", "A volume has one number a sample; the array of the VTK file has several."),
    (
        "E-vtk-feature",
        "The file uses a part of legacy VTK that is not read: other data sets than structured points, or vectors and other attributes before scalars.",
    ),
    (
        "E-vtk-header",
        "A line of a legacy VTK header is no known keyword, or one that is needed is missing: ASCII or BINARY, DATASET STRUCTURED_POINTS, DIMENSIONS, POINT_DATA or CELL_DATA, SCALARS.",
    ),
    ("E-vtk-magic", "A legacy VTK file begins with the line: # vtk DataFile Version, and a number."),
    ("E-vtk-number", "A number of a legacy VTK header does not read as one."),
    (
        "E-vtk-type",
        "The type of a legacy VTK array is one of bit, char, short, int, long, each also with unsigned_ before it, float and double.",
    ),
    ("E-write-empty", "The shape has no parts, and the format has no empty files."),
    (
        "E-write-finite",
        "A position is infinite or not a number, or becomes so where it is placed or in the numbers of the format. Repair the shape first.",
    ),
    ("E-write-format", "Files of this format are read but not written."),
    ("E-write-io", "The output could not be written: the disk may be full, or the folder read only."),
    (
        "E-write-kind",
        "The format cannot hold a part of this kind. Convert the part first, to triangles for most formats.",
    ),
    ("E-write-size", "The shape has more bytes or elements than the format can count."),
    (
        "E-write-turned",
        "Grids run along the axes. A height field that is turned or sheared can be written as triangles.",
    ),
    (
        "W-asc-nodata",
        "The header of an ESRI ASCII grid does not say which number stands for holes. It is -9999 then, and the grid has such numbers. If they are heights, add a line NODATA_value with another number.",
    ),
    (
        "W-asc-trailing",
        "More follows after the last sample of an ESRI ASCII grid. It was not read; the numbers of columns and rows may be wrong.",
    ),
    ("W-bpt-empty", "The file says that it has no patches; the surface is empty."),
    (
        "W-bpt-trailing",
        "More follows after the last patch. Everything up to there was read; the number of patches in the first line may be too small.",
    ),
    ("W-bpt-up", "BPT says nothing of directions, and its readers take z as up."),
    (
        "W-dem-grid",
        "Profiles of a USGS DEM do not begin at places of one grid. Their samples were moved to the nearest ones, by less than half a step.",
    ),
    ("W-dem-range", "The lowest and highest heights of a USGS DEM are not those that its header says."),
    ("W-dem-twice", "Two profiles of a USGS DEM have the same place. The later one counts."),
    (
        "W-dem-units",
        "A USGS DEM has places in one unit and heights in another, metres and feet. Heights were turned into the unit of places.",
    ),
    ("W-glb-chunk", "A chunk that glTF 2.0 does not define, or not in this place, was passed over."),
    ("W-glb-color", "Colours in whole numbers are sRGB; glTF stores linear intensities, and so they were converted."),
    (
        "W-glb-finite",
        "glTF asks for finite numbers. Values of attributes that are infinite or not a number were written as they are.",
    ),
    ("W-glb-normal", "glTF allows only normals of unit length, so normals without direction were replaced."),
    ("W-glb-padding", "The length of a chunk must be a multiple of four."),
    ("W-glb-single", "glTF stores attributes in single precision, about seven digits."),
    ("W-glb-trailing", "The file is longer than its header says; what follows was not read."),
    ("W-glb-up", "glTF has y up. The up axis of the shape is not known, so it was written without turning it."),
    (
        "W-gltf-corners",
        "The number of indices of a primitive does not go up in triangles, or segments; the last ones make none.",
    ),
    ("W-gltf-mark", "The document begins with a byte order mark, which glTF forbids."),
    ("W-gltf-matrix", "The last row of a node's matrix must be 0 0 0 1, and was taken as that."),
    (
        "W-gltf-parents",
        "A node has several parents, which glTF forbids: nodes must be a tree. Each way to it puts it somewhere else, so that it was read as instances.",
    ),
    ("W-gltf-position", "A primitive without positions shows nothing and was passed over."),
    ("W-gltf-rotation", "The rotation of a node must be a quaternion of unit length, and was scaled to it."),
    ("W-gltf-singular", "The transform of a node flattens space: the part has no volume, and normals no direction."),
    (
        "W-heights-alpha",
        "Pixels that are partly transparent have heights as if they were opaque. Only those wholly transparent are holes.",
    ),
    (
        "W-heights-degrees",
        "Places are degrees or seconds of arc, while heights are metres. Project the file with a program for maps, or multiply heights with the option exaggeration to have sensible proportions.",
    ),
    ("W-heights-empty", "No sample has a height."),
    (
        "W-heights-grey",
        "A picture in colours or with a palette has nothing but shades of grey: they were read exactly.",
    ),
    (
        "W-heights-holes",
        "Samples that are transparent, not a number or marked as without data are holes: cells that touch them are not part of the surface.",
    ),
    (
        "W-heights-scale",
        "A picture of whole numbers says neither how high white is nor how far apart its samples are. Say it with --set height=... and --set spacing=...",
    ),
    ("W-heights-spacing", "The file has heights, but not how far apart they are. Say it with --set spacing=..."),
    (
        "W-molecule-frames",
        "An XYZ file goes on after the atoms that it counts, with further frames of a motion or something else. The first frame was read.",
    ),
    (
        "W-molecule-label",
        "The name of an atom in an XYZ file is no symbol but begins with one, such as C12; it was taken for that element.",
    ),
    (
        "W-molecule-unknown",
        "The name of an atom in an XYZ file is no element. The atom was kept as one of an unknown element.",
    ),
    (
        "W-obj-color",
        "Vertex colours that are missing for some vertices or not finite were passed over; whole numbers were taken as bytes.",
    ),
    ("W-obj-corner", "Some corners of faces name no normal or texture coordinate where others do."),
    ("W-obj-degenerate", "A face names a vertex twice or has no area; it was kept."),
    ("W-obj-drawing", "A statement says how to draw the shape and was passed over."),
    ("W-obj-empty", "The file has no vertices."),
    ("W-obj-finite", "A normal or texture coordinate is infinite or not a number."),
    ("W-obj-freeform", "A statement belongs to free-form curves and was passed over."),
    ("W-obj-ignored", "A statement carries nothing that a mesh holds."),
    ("W-obj-library", "A material library was not read, in whole or in part: materials keep their names."),
    ("W-obj-material", "A material is used that no library has: only its name is known."),
    ("W-obj-name", "A name is longer than 1024 bytes and was cut: it would be repeated for every part that has it."),
    ("W-obj-skipped", "A face of fewer than three corners, or a line of fewer than two vertices, was passed over."),
    ("W-obj-smoothing", "A smoothing group is neither a number nor off."),
    ("W-obj-statement", "A line begins with a word that OBJ does not have."),
    ("W-obj-texture", "A texture that a material names is not beside the file. Its name was kept."),
    ("W-obj-weight", "A vertex has the weight 0. Weights mean nothing for polygons; they are kept as a column."),
    ("W-off-bright", "Some fractions of colours are above 1, brighter than white. They were kept as they are."),
    (
        "W-off-color",
        "A colour is infinite or not a number. It was taken as none: the vertex is white, the face grey, where others have a colour.",
    ),
    (
        "W-off-columns",
        "Vertices have three or four more numbers than the keyword promises. They were taken as a colour; say COFF if they are.",
    ),
    (
        "W-off-dark",
        "Colours of faces are whole numbers of which none is above 1. They were taken as bytes, nearly black; fractions have a decimal point.",
    ),
    ("W-off-degenerate", "A face names a vertex twice or has no area. It was kept."),
    ("W-off-empty", "The file has no vertices; the mesh is empty."),
    (
        "W-off-finite",
        "A normal or texture coordinate is infinite or not a number. It was kept as it is; only positions are left out on request.",
    ),
    (
        "W-off-fractions",
        "Colours of vertices are whole numbers of which none is above 1. They were taken as fractions, as Geomview takes them.",
    ),
    ("W-off-grey", "Some faces have a colour and others have none. These were taken as grey, as Geomview takes them."),
    ("W-off-header", "The number of vertices follows the keyword without a space."),
    ("W-off-mixed", "Some colours are in bytes and others in fractions. All became fractions."),
    ("W-off-skipped", "A face has fewer than three corners. It was left out."),
    ("W-off-trailing", "More follows after the last face. It was not read; the number of faces may be too small."),
    (
        "W-pdb-alternate",
        "A Protein Data Bank file gives some atoms at alternate locations. Of each residue the location that comes first was kept.",
    ),
    (
        "W-pdb-element",
        "Atoms of a Protein Data Bank file have no element in columns 77 and 78, as in old files; it was taken from their names.",
    ),
    ("W-pdb-models", "A Protein Data Bank file has several models. The first was read."),
    (
        "W-pdb-unknown",
        "Neither columns 77 and 78 nor the name of an atom in a Protein Data Bank file tell its element. It was kept as unknown.",
    ),
    ("W-pgm-trailing", "More follows after the last sample of a PGM file. It was not read."),
    ("W-ply-degenerate", "A face names a vertex twice or has no area. It was kept."),
    (
        "W-ply-edges",
        "The file has edges beside its faces. They became a part of their own, with copies of the vertices that they join.",
    ),
    ("W-ply-empty", "The file has no vertices: the mesh is empty."),
    ("W-ply-skipped", "A face has fewer than three corners. It was left out, with the rest of its row."),
    ("W-ply-strips", "A triangle strip has only one or two vertices, which make no triangle. It was left out."),
    (
        "W-ply-table",
        "An element that is called as faces, edges or strips are does not say which vertices it joins. It was kept as a table.",
    ),
    (
        "W-ply-texcoord",
        "A list of texture coordinates does not have two numbers for each corner of its face. It was kept as lists of the faces.",
    ),
    ("W-ply-trailing", "Data follows after the last row that the header promises. It was passed over."),
    ("W-ply-version", "The format has another version than 1.0, the only one there is. The file was read as that."),
    (
        "W-png-calibration",
        "A chunk that says what the samples of a PNG file mean was not understood and passed over: calibrations are linear ones from 0 on, sizes of pixels are in metres.",
    ),
    ("W-png-checksum", "A chunk of a PNG file that is not needed has a wrong checksum. It was passed over."),
    ("W-png-trailing", "More follows after the last chunk of a PNG file. It was not read."),
    ("W-read-dropped", "Vertices at positions that are infinite or not a number were left out, as was asked for."),
    ("W-stl-color", "Some facets of a binary STL file have a colour and others have none. These were taken as white."),
    ("W-stl-degenerate", "A facet has two equal corners, or its corners lie on one line. It was kept."),
    ("W-stl-empty", "The file has no facets; the mesh is empty."),
    ("W-stl-end", "The word endsolid stands where no solid has begun. It was passed over."),
    (
        "W-stl-nested",
        "A solid begins before the one before it has ended. Each is a part; the word endsolid may be missing.",
    ),
    (
        "W-stl-normal",
        "A stored normal is not three finite numbers. Stored normals are not kept: they follow from the corners.",
    ),
    (
        "W-stl-open",
        "The last solid does not end with the word endsolid. All facets were read; the file may be cut off between two of them.",
    ),
    ("W-stl-solid", "Facets without the word solid before them became a part without a name."),
    ("W-stl-trailing", "More follows after the last facet. It was not read; the count may be too small."),
    (
        "W-text-encoding",
        "A name or comment is not in UTF-8, which shapes keep. Bytes that could not be read were replaced; save the file as UTF-8 to keep them.",
    ),
    (
        "W-tiff-grid",
        "The tags that say where the samples of a TIFF file are make no grid along the axes. They were passed over.",
    ),
    ("W-tiff-images", "A TIFF file has several images, such as smaller copies of the first. The first was read."),
    (
        "W-tiff-nodata",
        "The tag GDAL_NODATA of a TIFF file says which number means that there is no height, but has no number. No samples were taken as holes by it: if some should be, they stand out as spikes or pits. Mend the tag, for instance with gdal_edit -a_nodata.",
    ),
    (
        "W-tiff-strip",
        "The number of bytes of a strip or tile in a TIFF file runs past the end of the file. Its pixels were there all the same, so only what they need was read.",
    ),
    (
        "W-volume-finite",
        "Some samples of a volume are infinite or no numbers, or too large for single precision. They are kept; isosurfaces take them as outside.",
    ),
    ("W-volume-quantity", "A file calls its samples occupancy, yet not all of them are 0 or 1."),
    (
        "W-volume-rounded",
        "Samples are kept in 8 or 16 bits without sign or in single precision. Wider numbers were rounded; the message says by how much at most.",
    ),
    (
        "W-volume-slices",
        "How many slices were read, and which was the last: those after a missing number are another stack.",
    ),
    ("W-volume-trailing", "More bytes follow after the samples of a volume than its header says. They were not read."),
    (
        "W-volume-truncated",
        "A file ends after its last sample, but before the checksum of compressed samples or the last tags of XML: all samples are there, but damage cannot be told. Get a complete copy.",
    ),
    ("W-vti-piece", "A VTI file is one piece of a larger whole, whose other pieces are in other files."),
    (
        "W-vtk-more",
        "More arrays follow after the first in a legacy VTK file; a voxel grid has one, so that they were not read.",
    ),
];

/// The explanation of a code of this crate.
pub fn explanation(code: &str) -> Option<&'static str> {
    EXPLANATIONS.iter().find(|(known, _)| *known == code).map(|(_, text)| *text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::{Path, PathBuf};

    fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.extension() {
                None => sources(&path, found),
                Some(word) if word == "rs" && !path.ends_with("explanations.rs") => found.push(path),
                Some(_) => {}
            }
        }
    }

    #[test]
    fn every_code_is_explained_and_every_explanation_has_a_code() {
        let mut files = Vec::new();
        sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
        let mut used = BTreeSet::new();
        for file in files {
            let text = std::fs::read_to_string(file).unwrap();
            for word in text.split('"').filter(|word| word.starts_with("E-") || word.starts_with("W-")) {
                let plain = word.bytes().all(|byte| byte.is_ascii_alphabetic() || byte == b'-');
                if plain && word.split('-').count() == 3 {
                    used.insert(word.to_owned());
                }
            }
        }
        let explained: BTreeSet<String> = EXPLANATIONS.iter().map(|(code, _)| (*code).to_owned()).collect();
        assert_eq!(used, explained);
        assert!(EXPLANATIONS.windows(2).all(|pair| pair[0].0 < pair[1].0));
        assert!(explanation("E-bpt-count").is_some() && explanation("E-none").is_none());
    }
}
